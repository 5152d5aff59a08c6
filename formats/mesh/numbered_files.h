// Files whose names differ in a number alone: the frames of a sequence, in their natural order (2
// before 10), whether or not there are leading zeros.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mdk {

/// A file's name (without folder), cut at the last run of digits before its extension.
struct NumberedName {
  std::string before;        ///< "walk_" of "walk_0007.obj"
  std::uint64_t number = 0;  ///< 7
  std::string after;         ///< ".obj"
};

/// Nothing where the name has no number, or one of more than 15 digits.
std::optional<NumberedName> numbered_name(const std::string& file_name);

struct NumberedFiles {
  std::string name;                    ///< "walk"; the folder's where nothing but a number is left
  std::vector<std::string> files;      ///< at least one
  std::vector<std::uint64_t> numbers;  ///< per file: rising
};

/// All numbered files of a folder whose extension (lower case, with its dot) is among `extensions`.
/// Throws Error: kIo (cannot read the folder), kBadInput (none, or more than one sequence).
NumberedFiles numbered_files_in(const std::string& folder,
                                std::span<const std::string_view> extensions);

/// Whether the file name holds a run of '#', and there is no file of just this name.
bool is_number_pattern(const std::string& path);

/// "walk_####.obj": all files that have a number, of any number of digits, in the place of the last
/// run of '#'. Throws Error: kIo (no such folder, or no such file), kBadInput (two of one number).
NumberedFiles files_of_pattern(const std::string& pattern);

/// The file and those of higher numbers, where the very next number is there, too; else the file
/// alone. Throws as files_of_pattern does.
NumberedFiles files_from(const std::string& first);

/// The files named, by their numbers where they differ in nothing else, and otherwise in the order
/// they are named in, numbered from 0. Throws Error (kUsage) for a file named twice.
NumberedFiles listed_files(std::span<const std::string> paths);

/// A sentence on numbers that are missing; empty where none is.
std::string gap_sentence(const NumberedFiles& sequence);

}  // namespace mdk
