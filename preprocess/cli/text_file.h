// Small files of text: reports, tables, dependencies.
#pragma once

#include <string>
#include <string_view>

namespace mdk {

/// Whole file or nothing. Throws Error (kIo).
void write_text_file(const std::string& path, std::string_view text);

}  // namespace mdk
