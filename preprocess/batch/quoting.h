// Words and paths as shells, ninja and make want them written.
#pragma once

#include <span>
#include <string>

namespace mdk {

/// As it is where that is safe, else in single quotes.
std::string shell_word(const std::string& word);

/// Words with blanks between.
std::string shell_line(std::span<const std::string> words);

/// A path in a build statement of ninja.
std::string ninja_path(const std::string& path);

/// A value in ninja: '$' doubled.
std::string ninja_value(const std::string& text);

/// A target or prerequisite of make. Throws Error (kUsage) where make has no way to write it.
std::string make_path(const std::string& path);

/// A recipe line of make: '$' doubled.
std::string make_recipe(const std::string& line);

}  // namespace mdk
