#include "preprocess/batch/path_pattern.h"

#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "common/base/error.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

using Parts = std::span<const std::string>;

bool part_matches(const std::string& pattern, const std::string& name) {
  return fnmatch(pattern.c_str(), name.c_str(), FNM_PERIOD) == 0;
}

bool parts_match(Parts pattern, Parts path) {
  if (pattern.empty()) return path.empty();
  if (pattern.front() == "**") {
    for (std::size_t skipped = 0; skipped <= path.size(); ++skipped) {
      if (parts_match(pattern.subspan(1), path.subspan(skipped))) return true;
      if (skipped < path.size() && path[skipped].starts_with('.')) return false;
    }
    return false;
  }
  return !path.empty() && part_matches(pattern.front(), path.front()) &&
         parts_match(pattern.subspan(1), path.subspan(1));
}

std::string joined(const std::string& folder, const std::string& name) {
  return folder.empty() || folder.ends_with('/') ? folder + name : folder + "/" + name;
}

/// Names in a folder, sorted by bytes; none where it cannot be read.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code problem;
  fs::directory_iterator entry(folder, problem);
  for (; !problem && entry != fs::directory_iterator(); entry.increment(problem))
    names.push_back(entry->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

/// Walks down the pattern's parts from `at`, a path relative to `root`.
void collect(const fs::path& root, const std::string& at, Parts pattern,
             std::vector<std::string>& found) {
  std::error_code problem;
  if (pattern.empty()) {
    if (fs::is_regular_file(root / at, problem)) found.push_back(at);
    return;
  }
  const std::string& part = pattern.front();
  if (part == "**") {
    collect(root, at, pattern.subspan(1), found);
    for (const std::string& name : names_in(root / at)) {
      const std::string below = joined(at, name);
      const fs::file_status status = fs::symlink_status(root / below, problem);
      if (!name.starts_with('.') && fs::is_directory(status)) collect(root, below, pattern, found);
    }
  } else if (!is_pattern(part)) {
    collect(root, joined(at, part), pattern.subspan(1), found);
  } else {
    for (const std::string& name : names_in(root / at))
      if (part_matches(part, name)) collect(root, joined(at, name), pattern.subspan(1), found);
  }
}

/// "../data/**/*.glb": "../data".
std::string fixed_folder(const std::string& pattern) {
  const std::size_t wild = pattern.find_first_of("*?[");
  const std::size_t slash = pattern.rfind('/', wild);
  return slash == std::string::npos ? "" : pattern.substr(0, slash);
}

}  // namespace

bool is_pattern(const std::string& path) { return path.find_first_of("*?[") != std::string::npos; }

bool matches_pattern(const std::string& pattern, const std::string& path) {
  return parts_match(split(pattern, '/'), split(path, '/'));
}

std::vector<std::string> files_matching(const std::string& folder, const std::string& pattern) {
  if (!is_pattern(pattern)) return {pattern};
  const bool rooted = pattern.starts_with('/');
  const std::vector<std::string> parts = split(rooted ? pattern.substr(1) : pattern, '/');
  std::vector<std::string> found;
  collect(rooted ? "/" : folder, rooted ? "/" : "", parts, found);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

std::string fill_name(const std::string& name, const std::string& path,
                      const std::string& pattern) {
  std::string filled;
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t open = name.find('{', at);
    filled += name.substr(at, open - at);
    if (open == std::string::npos) break;
    const std::size_t close = name.find('}', open);
    const std::string word =
        name.substr(open, close == std::string::npos ? close : close + 1 - open);
    if (word == "{stem}") {
      filled += fs::path(path).stem().string();
    } else if (word == "{folder}") {
      const fs::path below = fs::path(path).parent_path().lexically_relative(fixed_folder(pattern));
      const fs::path whole = fixed_folder(pattern).empty() ? fs::path(path).parent_path() : below;
      filled += whole.empty() || !is_pattern(pattern) ? "." : whole.string();
    } else {
      throw Error(ErrorCode::kUsage, "\"" + name + "\": " + word +
                                         " stands for nothing; there are {stem} and {folder}");
    }
    at = open + word.size();
  }
  return filled;
}

std::string plain_path(const std::string& path) {
  return fs::path(path).lexically_normal().string();
}

}  // namespace mdk
