// A glTF file as tinygltf understands it, for whoever turns that into checked structs.
#pragma once

#include <string>
#include <vector>

#include "formats/gltf_files.h"
#include "formats/gltf_schema.h"

namespace tinygltf {
class Model;
}

namespace mdk::gltf {

/// A file that the schema check has accepted.
struct GltfText {
  const std::string& path;
  const Bytes& bytes;  ///< of the .gltf or .glb
  const std::vector<ExternalBuffer>& external_buffers;
};

/// Reads the buffers beside the file, too, and adds them to `dependencies`. Nothing that the model
/// says is checked but its types and indices. Throws Error: kIo, kBadInput, kOverLimit.
tinygltf::Model parse_gltf(const GltfText& text, std::vector<std::string>& dependencies);

}  // namespace mdk::gltf
