#include "formats/mesh/numbered_files.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>
#include <utility>

#include "common/base/error.h"
#include "formats/files/file_kind.h"
#include "formats/files/text.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxDigits = 15;  // exact in a double, too
constexpr std::size_t kMaxGapsNamed = 8;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// Names of a folder's entries, but hidden ones, sorted.
std::vector<std::string> names_in(const std::string& folder) {
  std::error_code problem;
  std::vector<std::string> names;
  fs::directory_iterator entries(folder, problem);
  for (; !problem && entries != fs::directory_iterator(); entries.increment(problem)) {
    std::string name = entries->path().filename().string();
    if (!name.starts_with(".")) names.push_back(std::move(name));
  }
  if (problem) throw io_error(folder, "cannot be read: " + problem.message());
  std::sort(names.begin(), names.end());
  return names;
}

/// What is left of "walk_" for people.
std::string sequence_name(const std::string& before, const fs::path& folder) {
  const std::size_t end = before.find_last_not_of("_-. ");
  if (end != std::string::npos) return before.substr(0, end + 1);
  std::error_code problem;
  const fs::path whole = fs::weakly_canonical(folder, problem);
  const std::string name = (whole.has_filename() ? whole : whole.parent_path()).filename().string();
  return name.empty() ? "sequence" : name;
}

struct NumberedPath {
  std::uint64_t number = 0;
  std::string path;
};

NumberedFiles in_order(std::string name, std::vector<NumberedPath> found, ErrorCode twice) {
  std::stable_sort(found.begin(), found.end(), [](const NumberedPath& a, const NumberedPath& b) {
    return a.number < b.number;
  });
  NumberedFiles sequence{std::move(name), {}, {}};
  for (NumberedPath& file : found) {
    if (!sequence.numbers.empty() && sequence.numbers.back() == file.number)
      throw Error(twice, file.path + ": has the same number as " + sequence.files.back() +
                             "; leave one of them out");
    sequence.numbers.push_back(file.number);
    sequence.files.push_back(std::move(file.path));
  }
  return sequence;
}

/// All files in `folder` that are called `before`, a number, `after`.
NumberedFiles matching(const fs::path& folder, bool name_folder, const NumberedName& pattern) {
  std::vector<NumberedPath> found;
  for (const std::string& name : names_in(folder.string())) {
    const std::size_t around = pattern.before.size() + pattern.after.size();
    if (name.size() <= around || !name.starts_with(pattern.before) ||
        !name.ends_with(pattern.after))
      continue;
    const std::string digits = name.substr(pattern.before.size(), name.size() - around);
    if (digits.size() > kMaxDigits || !std::all_of(digits.begin(), digits.end(), is_digit))
      continue;
    found.push_back(
        {*parsed<std::uint64_t>(digits), name_folder ? (folder / name).string() : name});
  }
  return in_order(sequence_name(pattern.before, folder), std::move(found), ErrorCode::kBadInput);
}

/// The last run of '#' in the file's name, as what stands around it.
std::optional<NumberedName> pattern_of(const std::string& file_name) {
  const std::size_t last = file_name.find_last_of('#');
  if (last == std::string::npos) return std::nullopt;
  const std::size_t before = file_name.find_last_not_of('#', last);
  return NumberedName{before == std::string::npos ? "" : file_name.substr(0, before + 1), 0,
                      file_name.substr(last + 1)};
}

}  // namespace

std::optional<NumberedName> numbered_name(const std::string& file_name) {
  std::size_t end = fs::path(file_name).stem().string().size();
  while (end > 0 && !is_digit(file_name[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && is_digit(file_name[begin - 1])) --begin;
  if (begin == end || end - begin > kMaxDigits) return std::nullopt;
  const std::string digits = file_name.substr(begin, end - begin);
  return NumberedName{file_name.substr(0, begin), *parsed<std::uint64_t>(digits),
                      file_name.substr(end)};
}

NumberedFiles numbered_files_in(const std::string& folder,
                                std::span<const std::string_view> extensions) {
  std::map<std::pair<std::string, std::string>, NumberedName> kinds;
  for (const std::string& name : names_in(folder)) {
    if (std::ranges::find(extensions, lower_extension(name)) == extensions.end()) continue;
    if (const std::optional<NumberedName> parts = numbered_name(name))
      kinds.try_emplace({parts->before, parts->after}, *parts);
  }
  if (kinds.empty())
    throw bad_input(folder, "is a folder without numbered .obj or .ply files; name a file");
  const auto shown = [](const NumberedName& n) { return "'" + n.before + "####" + n.after + "'"; };
  if (kinds.size() > 1)
    throw bad_input(folder, "holds more than one sequence (" + shown(kinds.begin()->second) + ", " +
                                shown(std::next(kinds.begin())->second) +
                                (kinds.size() > 2 ? ", …" : "") +
                                "); name one of them, with the folder before it");
  return matching(folder, true, kinds.begin()->second);
}

bool is_number_pattern(const std::string& path) {
  std::error_code ignored;
  return pattern_of(fs::path(path).filename().string()) && !fs::exists(path, ignored);
}

NumberedFiles files_of_pattern(const std::string& pattern) {
  const fs::path path(pattern);
  const std::optional<NumberedName> parts = pattern_of(path.filename().string());
  NumberedFiles sequence = matching(folder_of(path), path.has_parent_path(), *parts);
  if (sequence.files.empty())
    throw io_error(pattern, "there is no file with a number in the place of the '#'");
  return sequence;
}

NumberedFiles files_from(const std::string& first) {
  const fs::path path(first);
  const std::string file_name = path.filename().string();
  const NumberedFiles alone{path.stem().string(), {first}, {0}};
  const std::optional<NumberedName> parts = numbered_name(file_name);
  // A folder that cannot be listed may still give a file that is known by name.
  std::error_code problem;
  const fs::directory_iterator folder(folder_of(path), problem);
  if (!parts || problem || !fs::exists(path, problem)) return alone;
  NumberedFiles all = matching(folder_of(path), path.has_parent_path(), *parts);
  const auto begin = std::ranges::lower_bound(all.numbers, parts->number) - all.numbers.begin();
  all.numbers.erase(all.numbers.begin(), all.numbers.begin() + begin);
  all.files.erase(all.files.begin(), all.files.begin() + begin);
  if (all.numbers.size() < 2 || all.numbers[1] != parts->number + 1) return alone;
  return all;
}

NumberedFiles listed_files(std::span<const std::string> paths) {
  std::vector<NumberedPath> numbered, listed;
  std::optional<NumberedName> kind;
  bool are_alike = true;
  for (const std::string& path : paths) {
    listed.push_back({listed.size(), path});
    const std::optional<NumberedName> parts = numbered_name(fs::path(path).filename().string());
    if (!kind) kind = parts;
    are_alike &= parts && kind && parts->before == kind->before && parts->after == kind->after &&
                 fs::path(path).parent_path() == fs::path(paths.front()).parent_path();
    if (are_alike) numbered.push_back({parts->number, path});
    if (std::ranges::count(paths, path) > 1)
      throw Error(ErrorCode::kUsage, path + ": is named twice; leave one out");
  }
  if (!are_alike)
    return in_order(fs::path(paths.front()).stem().string(), std::move(listed), ErrorCode::kUsage);
  return in_order(sequence_name(kind->before, folder_of(paths.front())), std::move(numbered),
                  ErrorCode::kUsage);
}

std::string gap_sentence(const NumberedFiles& sequence) {
  const std::vector<std::uint64_t>& numbers = sequence.numbers;
  std::vector<std::string> gaps;
  bool is_even = numbers.size() > 2;
  for (std::size_t i = 1; i < numbers.size(); ++i) {
    const std::uint64_t first = numbers[i - 1] + 1, last = numbers[i] - 1;
    is_even &= numbers[i] - numbers[i - 1] == numbers[1] - numbers[0];
    if (first > last) continue;
    gaps.push_back(std::to_string(first) + (first < last ? " to " + std::to_string(last) : ""));
  }
  if (gaps.empty()) return {};
  if (is_even)
    return "the files of " + sequence.name + " are numbered in steps of " +
           std::to_string(numbers[1] - numbers[0]) + ", and so many frames are between two keys";
  std::string text = "files of " + sequence.name + " are missing, numbers ";
  for (std::size_t i = 0; i < std::min(gaps.size(), kMaxGapsNamed); ++i)
    text += (i ? ", " : "") + gaps[i];
  if (gaps.size() > kMaxGapsNamed)
    text += " and " + std::to_string(gaps.size() - kMaxGapsNamed) + " more runs";
  return text + "; vertices move straight across the gaps";
}

}  // namespace mdk
