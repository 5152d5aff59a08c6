// Decodes primitives of KHR_draco_mesh_compression, where Draco was there at build time.
#pragma once

#include <span>

#include "formats/gltf_compression.h"
#include "formats/gltf_document.h"

namespace mdk::gltf {

bool can_decode_draco();

/// Gives the primitive's accessors the data that `compressed` holds, as numbers of the types they
/// have (the index list: 32 bits). Before anything is decoded, the counts in Draco's header are
/// compared with the accessors' and with what so many bytes can hold. Throws Error (kBadInput).
void decode_draco(const DracoPrimitive& primitive, std::span<const unsigned char> compressed,
                  Document& document);

}  // namespace mdk::gltf
