#include "preprocess/batch/quoting.h"

#include <string_view>

#include "common/base/error.h"

namespace mdk {
namespace {

constexpr std::string_view kPlain =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";

std::string with_prefixed(const std::string& text, std::string_view special, char prefix) {
  std::string result;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) result += prefix;
    result += c;
  }
  return result;
}

}  // namespace

std::string shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) {
    if (c == '\'') {
      quoted += "'\\''";
    } else {
      quoted += c;
    }
  }
  return quoted + "'";
}

std::string shell_line(std::span<const std::string> words) {
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    line += shell_word(word);
  }
  return line;
}

std::string ninja_path(const std::string& path) { return with_prefixed(path, "$ :", '$'); }

std::string ninja_value(const std::string& text) { return with_prefixed(text, "$", '$'); }

std::string make_path(const std::string& path) {
  if (path.find_first_of("\\:;=*?[~'\"`()<>|&") != std::string::npos)
    throw Error(ErrorCode::kUsage, path +
                                       ": make cannot hold this name as a target; rename it, or "
                                       "use --ninja");
  return with_prefixed(with_prefixed(path, " #%", '\\'), "$", '$');
}

std::string make_recipe(const std::string& line) { return with_prefixed(line, "$", '$'); }

}  // namespace mdk
