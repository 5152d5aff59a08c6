// Patterns that name many files at once, as in a shell, and names made from what they match.
#pragma once

#include <string>
#include <vector>

namespace mdk {

/// Whether it has any of * ? [.
bool is_pattern(const std::string& path);

/// Whether `path` is named by `pattern`: * and ? stand for anything but '/', [a-z] for one
/// character of a set, a whole part ** for any number of folders, none too. A leading dot must be
/// written.
bool matches_pattern(const std::string& pattern, const std::string& path);

/// Files below `folder` that the pattern names, as the pattern writes them, sorted by bytes, so
/// that a list does not depend on the machine. A path without a pattern is itself, there or not.
std::vector<std::string> files_matching(const std::string& folder, const std::string& pattern);

/// `name` with {stem} for the file name of `path` without its extension, and {folder} for its
/// folder below the part of `pattern` that has no wildcard; folders in "." are none. Throws Error
/// (kUsage) for other words in braces.
std::string fill_name(const std::string& name, const std::string& path, const std::string& pattern);

/// Without ".", "//" and "x/..".
std::string plain_path(const std::string& path);

}  // namespace mdk
