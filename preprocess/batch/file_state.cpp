#include "preprocess/batch/file_state.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "common/base/error.h"
#include "formats/mapped_file.h"
#include "formats/mdk_sections.h"

namespace mdk {
namespace {

bool is_unchanged(const FileState& state) {
  std::error_code problem;
  if (std::filesystem::file_size(state.path, problem) != state.bytes || problem) return false;
  try {
    return state_of_file(state.path) == state;
  } catch (const Error&) {
    return false;  // whoever needs the file will say what is wrong with it
  }
}

}  // namespace

FileState state_of_file(const std::string& path) {
  const MappedFile file(path);
  return {path, file.bytes().size(), checksum_of(file.bytes())};
}

std::vector<FileState> states_of_files(const std::vector<std::string>& paths) {
  std::vector<FileState> states;
  for (const std::string& path : paths) states.push_back(state_of_file(path));
  return states;
}

bool are_unchanged(const std::vector<FileState>& states) {
  return std::all_of(states.begin(), states.end(), is_unchanged);
}

bool is_readable(const std::string& path) {
  std::error_code problem;
  return std::filesystem::is_regular_file(path, problem) && std::ifstream(path).is_open();
}

}  // namespace mdk
