// A glTF file as tinygltf understands it, for the conversion into checked structs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "formats/gltf/files.h"

namespace tinygltf {
class Model;
}

namespace mdk::gltf {

struct Schema;

/// The JSON of a .gltf, or of a .glb's first chunk; points into `bytes`. Throws Error (kBadInput)
/// where a .glb is not version 2, or a chunk reaches past its end.
std::string_view json_text(const std::string& path, const Bytes& bytes);

/// `schema`: of the file's json_text(). Reads the buffers beside the file, too, and adds them to
/// `dependencies`; images stay encoded. Throws Error: kIo, kBadInput, kOverLimit.
tinygltf::Model parse_gltf(const std::string& path, const Bytes& bytes, const Schema& schema,
                           std::vector<std::string>& dependencies);

}  // namespace mdk::gltf
