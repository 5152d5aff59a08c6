// What a glTF file's JSON must look like before anything else reads it. tinygltf takes a property
// of the wrong type for an absent one, checks few indices, and recurses without a limit; here every
// property that is used has its type, every index points at something, and nesting is bounded.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "formats/gltf_compression.h"

namespace mdk::gltf {

struct ExternalBuffer {
  std::size_t number = 0;
  std::string uri;  ///< as written, still percent-encoded
  std::size_t bytes = 0;
};

struct SchemaSummary {
  std::vector<ExternalBuffer> external_buffers;  ///< in the order of the file's buffers
  std::vector<std::string> ignored_extensions;   ///< used by the file, unknown here, not required
  Compression compression;
  std::string plain_json;  ///< what knows no compression is to read instead; empty: the file's own
};

/// Checks the JSON text of `file` (for messages). Afterwards every index is in range, every buffer
/// view lies inside its buffer's byteLength, and every required extension is known. Throws Error
/// (kBadInput) naming the place. Cost: one parse.
SchemaSummary check_schema(const std::string& file, std::string_view json);

/// Throws Error (kBadInput) where arrays and objects are nested deeper than any honest file does.
/// Cost: one pass over the characters, no recursion.
void check_nesting(const std::string& file, std::string_view json);

}  // namespace mdk::gltf
