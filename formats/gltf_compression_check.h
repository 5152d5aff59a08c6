// The part of the schema check that is about compressed data.
#pragma once

#include <string>

#include "formats/gltf_compression.h"
#include "formats/gltf_json_check.h"

namespace mdk::gltf {

/// Lists what is compressed in a file whose other properties are checked. Throws Error: kBadInput
/// (a property is wrong, sizes that the compressed bytes cannot hold, or what this build has no
/// decoder for and no plain copy of), kOverLimit (decodes to over 4 GiB).
Compression check_compression(const std::string& file, const Json& root);

/// The file for a reader that knows no compression: buffers without data become one byte, and
/// compressed primitives lose their index lists, whose accessors lead nowhere.
void hide_compression(const Compression& compression, Json& root);

}  // namespace mdk::gltf
