// Small files of text: reports, tables, dependencies.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mdk {

/// Whole file or nothing. Throws Error (kIo).
void write_text_file(const std::string& path, std::string_view text);

/// Throws Error: kIo, or kOverLimit where the file is larger than `limit` bytes.
std::string read_text_file(const std::string& path, std::size_t limit);

}  // namespace mdk
