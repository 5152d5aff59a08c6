// The files a glTF file may read: itself, and what its URIs name beside it.
#pragma once

#include <string>
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

}  // namespace mdk::gltf
