// mdk-assimp INPUT: what Assimp reads of a file, on stdout (formats/assimp_answer.h). A program of
// its own, since Assimp takes files at their word: where one makes it crash, run on or eat memory,
// this process ends and the one that waits for it says so.
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/version.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <new>

#include "common/base/error.h"
#include "common/base/text.h"
#include "formats/assimp/neighbor_files.h"
#include "formats/assimp/scene_glb.h"
#include "formats/assimp/scene_import.h"
#include "formats/assimp_answer.h"

namespace mdk {
namespace {

void lower_limit(int resource, rlim_t most) {
  rlimit limit{};
  getrlimit(static_cast<__rlimit_resource>(resource), &limit);
  limit.rlim_cur = std::min(limit.rlim_cur, most);
  setrlimit(static_cast<__rlimit_resource>(resource), &limit);
}

/// What RLIMIT_DATA counts, before anything is read.
std::uint64_t data_bytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t pages = 0;
  for (int field = 0; field < 6; ++field) statm >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limit_process() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  lower_limit(RLIMIT_CORE, 0);
  lower_limit(RLIMIT_CPU, kMaxAssimpSeconds);
  lower_limit(RLIMIT_DATA, data_bytes() + kMaxAssimpBytes);
  lower_limit(RLIMIT_FSIZE, kMaxAssimpBytes);
}

std::string version_text() {
  return std::to_string(aiGetVersionMajor()) + "." + std::to_string(aiGetVersionMinor()) + "." +
         std::to_string(aiGetVersionPatch());
}

Error refused(const std::string& path, const std::string& reason) {
  if (reason.find("bad_alloc") != std::string::npos) throw std::bad_alloc();
  std::string words = printable_line(reason).substr(0, 200);
  while (!words.empty() && (words.back() == '.' || words.back() == ' ')) words.pop_back();
  return bad_input(path, "cannot be read by Assimp (" + words + "); export it again, or as glTF");
}

void import_file(const std::string& path) {
  if (std::error_code error; !std::filesystem::is_regular_file(path, error))
    throw io_error(
        path, std::filesystem::exists(path, error) ? "is not a file" : "there is no such file");
  if (::access(path.c_str(), R_OK) != 0)
    throw io_error(path, "cannot be opened; check its permissions");
  const std::filesystem::path name = std::filesystem::path(path).filename();
  auto* files = new NeighborFiles(path);
  Assimp::Importer importer;
  importer.SetIOHandler(files);  // which owns it from here on
  // A skeleton alone is drawn for motion capture, where there is never a mesh.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, !has_extension(path, ".bvh"));
  const aiScene* scene = importer.ReadFile(name.string(), aiProcess_Triangulate);
  if (scene == nullptr) throw refused(path, importer.GetErrorString());
  const SceneGlb glb = encode_scene(*scene, path);
  write_assimp_answer({version_text(), files->opened(), glb.notes, glb.bytes}, STDOUT_FILENO);
}

int run(const std::string& path) {
  limit_process();
  try {
    import_file(path);
    return 0;
  } catch (const Error& error) {
    std::cerr << kAssimpProgram << ": " << error.what() << "\n";
    return error.exit_status();
  } catch (const std::bad_alloc&) {
    std::cerr << kAssimpProgram << ": " << path
              << ": takes Assimp more memory than it may have; allow more, or export it as glTF\n";
    return static_cast<int>(ErrorCode::kOverLimit);
  } catch (const std::exception& error) {
    std::cerr << kAssimpProgram << ": " << refused(path, error.what()).what() << "\n";
    return static_cast<int>(ErrorCode::kBadInput);
  }
}

}  // namespace
}  // namespace mdk

int main(int count, char** words) {
  // Assimp's own clearing up is left to the system.
  if (count == 2) ::_exit(mdk::run(words[1]));
  std::cerr << "usage: " << mdk::kAssimpProgram << " INPUT (mdprep starts it by itself)\n";
  return static_cast<int>(mdk::ErrorCode::kUsage);
}
