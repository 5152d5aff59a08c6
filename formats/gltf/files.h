// The files a glTF file may read: itself, and what its URIs name beside it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
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

/// The bytes of a "data:…;base64,…" URI, up to the first character that is none of base64's.
/// Nothing for any other URI.
std::optional<Bytes> data_uri_bytes(std::string_view uri);

/// Both point into the file's bytes.
struct FileParts {
  std::string_view json;
  std::span<const unsigned char> binary;  ///< of a .glb; empty where there is none
};

/// A .gltf, or a .glb taken apart. Throws Error (kBadInput) where a .glb is cut short or is not
/// version 2.
FileParts file_parts(const std::string& path, const Bytes& bytes);

}  // namespace mdk::gltf
