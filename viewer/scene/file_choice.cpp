#include "viewer/scene/file_choice.h"

#include <filesystem>

namespace mdk {

void remember_file(std::vector<FileChoice>& recent, const std::vector<std::string>& paths) {
  if (paths.empty()) return;
  FileChoice choice;
  std::error_code failure;
  for (const std::string& path : paths) {
    const auto whole = std::filesystem::absolute(path, failure).lexically_normal();
    choice.paths.push_back(failure ? path : whole.string());
  }
  const std::filesystem::path first(choice.paths.front());
  choice.label = first.has_filename() ? first.filename().string()
                                      : first.parent_path().filename().string() + "/";
  std::erase_if(recent, [&](const FileChoice& old) { return old.paths == choice.paths; });
  recent.insert(recent.begin(), std::move(choice));
  if (recent.size() > kMostRecentFiles) recent.resize(kMostRecentFiles);
}

}  // namespace mdk
