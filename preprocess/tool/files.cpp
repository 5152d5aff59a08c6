#include "preprocess/tool/files.h"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "common/base/error.h"
#include "formats/files/atomic_file.h"
#include "formats/files/mapped_file.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

bool same_file(const std::string& a, const std::string& b) {
  std::error_code problem;
  if (fs::equivalent(a, b, problem) && !problem) return true;
  const fs::path whole_a = fs::weakly_canonical(a, problem);
  if (problem) return a == b;
  const fs::path whole_b = fs::weakly_canonical(b, problem);
  return problem ? a == b : whole_a == whole_b;
}

/// [first, last) of the last run of '#' in the file name; both npos where there is none.
struct NumberPlace {
  std::size_t first = std::string::npos, last = std::string::npos;
};

NumberPlace find_number_place(const std::string& pattern) {
  const std::size_t slash = pattern.rfind('/');
  const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
  const std::size_t at = pattern.rfind('#');
  if (at == std::string::npos || at < name) return {};
  std::size_t first = at;
  while (first > name && pattern[first - 1] == '#') --first;
  return {first, at + 1};
}

std::string escaped_for_make(const std::string& name) {
  std::string text;
  std::size_t backslashes = 0;  // that end `text`: they double where they stand before an escape
  for (const char c : name) {
    if (c == '\n' || c == '\r')
      throw Error(ErrorCode::kUsage,
                  "the name of a file has a line break, which no depfile can hold; rename it");
    if (c == ' ' || c == '\t' || c == '#') text.append(backslashes + 1, '\\');
    if (c == '$') text += '$';
    text += c;
    backslashes = c == '\\' ? backslashes + 1 : 0;
  }
  return text;
}

}  // namespace

void require_writable_place(const std::string& path) {
  std::error_code problem;
  if (path.empty()) throw Error(ErrorCode::kUsage, "an output needs a name, not \"\"");
  if (fs::is_directory(path, problem))
    throw io_error(path, "is a folder; give the name of a file in it");
  const fs::file_status status = fs::status(path, problem);
  if (fs::exists(status) && !fs::is_regular_file(status))
    throw io_error(path,
                   "cannot be written: it is not a regular file, and would be replaced by one");
  const fs::path parent = fs::path(path).parent_path();
  const std::string folder = parent.empty() ? "." : parent.string();
  if (!fs::is_directory(folder, problem))
    throw io_error(path, "cannot be written, there is no folder " + folder + "; make it first");
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw io_error(path, "cannot be written, the folder " + folder +
                             " is not writable; choose another or change its permissions");
}

void require_distinct_files(const std::string& input, std::span<const std::string> outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].empty()) continue;
    if (same_file(input, outputs[i]))
      throw Error(ErrorCode::kUsage,
                  outputs[i] + ": is the input; give the output a name of its own");
    for (std::size_t j = 0; j < i; ++j)
      if (!outputs[j].empty() && same_file(outputs[j], outputs[i]))
        throw Error(ErrorCode::kUsage,
                    outputs[i] + ": two outputs have this name; give each its own");
  }
}

bool has_number_place(const std::string& pattern) {
  return find_number_place(pattern).first != std::string::npos;
}

std::string numbered_path(const std::string& pattern, std::uint32_t number) {
  const NumberPlace place = find_number_place(pattern);
  std::string digits = std::to_string(number);
  const std::size_t width = place.last - place.first;
  if (digits.size() < width) digits.insert(0, width - digits.size(), '0');
  return numbered_path(pattern, digits);
}

std::string numbered_path(const std::string& pattern, const std::string& text) {
  const NumberPlace place = find_number_place(pattern);
  if (place.first == std::string::npos) return pattern;
  return pattern.substr(0, place.first) + text + pattern.substr(place.last);
}

void write_text_file(const std::string& path, std::string_view text) {
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(text.data(), text.size())));
  file.commit();
}

std::string read_text_file(const std::string& path, std::size_t limit) {
  const MappedFile file(path);
  const std::span<const std::byte> bytes = file.bytes();
  if (bytes.size() > limit)
    throw Error(ErrorCode::kOverLimit, path + ": is larger than the " + std::to_string(limit) +
                                           " bytes that such a file may have");
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string depfile_text(const std::string& target, std::span<const std::string> dependencies) {
  std::string text = escaped_for_make(target) + ":";
  for (const std::string& name : dependencies) text += " \\\n  " + escaped_for_make(name);
  return text + "\n";
}

}  // namespace mdk
