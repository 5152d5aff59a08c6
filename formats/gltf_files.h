// The files a glTF file may read: itself, and what its URIs name beside it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mdk::gltf {

using Bytes = std::vector<unsigned char>;

/// The whole file. Throws Error: kIo where it cannot be read or is no regular file, kOverLimit over
/// 4 GiB.
Bytes read_whole_file(const std::string& path);

/// Where the relative `uri` of `gltf_path` leads, percent-decoded. Throws Error (kBadInput) for a
/// URI with a scheme, an absolute path, or one that leaves the folder of `gltf_path`, as
/// neighbor_path judges it.
std::string resolve_uri(const std::string& gltf_path, const std::string& uri);

/// Whether the bytes start like a binary glTF.
bool is_glb(const Bytes& bytes);

/// The JSON of a .gltf, or of a .glb's first chunk; points into `bytes`. Throws Error (kBadInput)
/// where a .glb has no whole JSON chunk or is not version 2.
std::string_view json_text(const std::string& path, const Bytes& bytes);

/// The same file with another JSON; json_text() must have accepted it.
Bytes with_json(const Bytes& bytes, std::string_view json);

}  // namespace mdk::gltf
