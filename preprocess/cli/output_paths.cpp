#include "preprocess/cli/output_paths.h"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "common/base/error.h"

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

}  // namespace mdk
