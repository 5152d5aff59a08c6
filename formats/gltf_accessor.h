// Accessors, read: strides, sparse replacements and normalised integers resolved.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/gltf_document.h"

namespace mdk::gltf {

/// Bytes of one number.
std::size_t component_bytes(ComponentType type);

/// All numbers of an accessor, element after element: count * components. Normalised integers
/// become [0, 1] or [-1, 1], other integers their value. Throws Error (kBadInput) for a number that
/// is not finite.
std::vector<float> read_floats(const Document& document, int accessor);

/// The same for unsigned integers. Throws Error (kBadInput) for signed, float or normalised ones.
std::vector<std::uint32_t> read_unsigned(const Document& document, int accessor);

/// The accessor, if it has `components` numbers an element. Throws Error (kBadInput) naming `place`
/// ("mesh 0, primitive 1: NORMAL") otherwise.
const Accessor& expect_components(const Document& document, int accessor, int components,
                                  const std::string& place);

}  // namespace mdk::gltf
