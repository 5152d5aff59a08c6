// Decodes buffer views of EXT_meshopt_compression, where meshoptimizer was there at build time.
#pragma once

#include <span>

#include "formats/gltf_compression.h"
#include "formats/gltf_files.h"

namespace mdk::gltf {

bool can_decode_meshopt();

/// The view's bytes: count * stride. Empty where the data is broken (indices may still be out of
/// range: whoever uses them checks).
Bytes decode_meshopt(const MeshoptView& view, std::span<const unsigned char> compressed);

}  // namespace mdk::gltf
