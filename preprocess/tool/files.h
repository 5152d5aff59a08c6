// The files that a command writes: refused before any time is spent on them where they cannot work,
// named by number, small texts written whole, and dependencies listed for make and ninja.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace mdk {

/// Throws Error (kIo) where `path` cannot become a file: its folder is missing or not writable, or
/// it is a folder itself.
void require_writable_place(const std::string& path);

/// Throws Error (kUsage) where two outputs, or an output and `input`, are one file. Empty outputs
/// stand for outputs that were not asked for.
void require_distinct_files(const std::string& input, std::span<const std::string> outputs);

/// Whether the file name (not its folder) has a run of '#'.
bool has_number_place(const std::string& pattern);

/// The last run of '#' in the file name becomes `number` with as many digits at least:
/// "out_####.png", 7 -> "out_0007.png". Without one: the pattern itself.
std::string numbered_path(const std::string& pattern, std::uint32_t number);

/// The same with any text in place of the run.
std::string numbered_path(const std::string& pattern, const std::string& text);

/// Whole file or nothing. Throws Error (kIo).
void write_text_file(const std::string& path, std::string_view text);

/// Throws Error: kIo, or kOverLimit where the file is larger than `limit` bytes.
std::string read_text_file(const std::string& path, std::size_t limit);

/// "out.mdk: a.gltf a.bin", one rule, with blanks, '#' and '$' in names escaped. Throws Error
/// (kUsage) for a name with a line break, which the form cannot hold.
std::string depfile_text(const std::string& target, std::span<const std::string> dependencies);

}  // namespace mdk
