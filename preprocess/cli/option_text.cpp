// An option that nobody has put on one of the lists below counts: a needless second run is cheap, a
// stale result is not.
#include "preprocess/cli/option_text.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

namespace mdk {
namespace {

constexpr std::array<std::string_view, 8> kNoResultDependsOn = {
    "help", "threads", "isa", "memory-limit", "progress", "quiet", "verbose", "depfile"};
constexpr std::array<std::string_view, 6> kFileNames = {"INPUT",  "FILE",   "output",
                                                        "report", "source", "stats"};

constexpr std::array<std::string_view, 2> kClipNames = {"clips", "clip"};

template <class List>
bool has(const List& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

bool counts(const std::string& name, OptionScope scope) {
  if (has(kNoResultDependsOn, name)) return false;
  return scope == OptionScope::kResults || !has(kFileNames, name);
}

/// "30.0" and "3e1" become "30"; other words stay.
std::string one_spelling(const std::string& word) {
  double value = 0;
  const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
  if (read.ec != std::errc() || read.ptr != word.data() + word.size() || !std::isfinite(value))
    return word;
  std::array<char, 32> digits{};
  const auto written = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  return {digits.data(), written.ptr};
}

/// A name may look like a number: "10" and "10.0" are two clips.
bool is_name(const std::string& option) {
  return has(kFileNames, option) || has(kClipNames, option);
}

std::string value_text(const CLI::Option& option) {
  std::string text;
  for (const std::string& word : option.results()) {
    if (!text.empty()) text += "\n ";
    text += is_name(option.get_single_name()) ? word : one_spelling(word);
  }
  return text;
}

}  // namespace

OptionText::OptionText(CLI::App& command) : command_(&command) {
  for (CLI::Option* option : command.get_options()) {
    option->capture_default_str();
    const std::string name = option->get_single_name(), value = option->get_default_str();
    defaults_[name] = is_name(name) ? value : one_spelling(value);
    option->default_str("");  // the help tells defaults in its own words
  }
}

std::string OptionText::text(OptionScope scope) const {
  std::map<std::string, std::string> lines;
  for (const CLI::Option* option : command_->get_options()) {
    const std::string name = option->get_single_name();
    if (option->count() == 0 || !counts(name, scope)) continue;
    const std::string value = value_text(*option);
    const auto known = defaults_.find(name);
    if (known == defaults_.end() || known->second != value) lines[name] = value;
  }
  std::string text;
  for (const auto& [name, value] : lines) text += name + "=" + value + "\n";
  return text;
}

}  // namespace mdk
