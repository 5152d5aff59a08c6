// mdk-assimp INPUT: what Assimp reads of a file, on stdout (answer.h). A program of its own, since
// Assimp takes files at their word: where one makes it crash, run on or eat memory, this process
// ends and the one that waits for it says so.
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/version.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <assimp/IOStream.hpp>
#include <assimp/IOSystem.hpp>
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
#include <system_error>
#include <utility>
#include <vector>

#include "common/base/error.h"
#include "common/base/text.h"
#include "formats/assimp/answer.h"
#include "formats/assimp/import.h"
#include "formats/files/file_kind.h"
#include "formats/gltf/files.h"

namespace mdk {
namespace {

class LoadedFile final : public Assimp::IOStream {
 public:
  explicit LoadedFile(gltf::Bytes bytes) : bytes_(std::move(bytes)) {}

  std::size_t Read(void* out, std::size_t size, std::size_t count) override {
    if (size == 0) return 0;
    const std::size_t whole = std::min(count, (bytes_.size() - at_) / size);
    if (whole > 0) std::memcpy(out, bytes_.data() + at_, whole * size);
    at_ += whole * size;
    return whole;
  }
  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }
  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t from = origin == aiOrigin_SET   ? 0
                             : origin == aiOrigin_CUR ? at_
                                                      : bytes_.size();
    const std::size_t to = origin == aiOrigin_END ? from - offset : from + offset;
    const bool is_inside = to <= bytes_.size() && (origin == aiOrigin_END || to >= from);
    if (is_inside) at_ = to;
    return is_inside ? aiReturn_SUCCESS : aiReturn_FAILURE;
  }
  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  gltf::Bytes bytes_;
  std::size_t at_ = 0;
};

/// Assimp 5.2 takes a line of an MD5 text that ends in "\n" alone for one that goes on.
bool wants_carriage_returns(const std::string& path) {
  const std::string extension = lower_extension(path);
  return extension == ".md5mesh" || extension == ".md5anim";
}

gltf::Bytes with_carriage_returns(const gltf::Bytes& text) {
  gltf::Bytes out;
  for (const unsigned char c : text) {
    if (c == '\n' && (out.empty() || out.back() != '\r')) out.push_back('\r');
    out.push_back(c);
  }
  return out;
}

/// Assimp sees the input's folder as all there is: names that lead out of it do not exist, and
/// nothing is ever written.
class NeighborFiles final : public Assimp::IOSystem {
 public:
  explicit NeighborFiles(std::string input) : input_(std::move(input)) {}

  bool Exists(const char* name) const override;
  char getOsSeparator() const override { return '/'; }
  /// The whole file, read at once; null where it cannot be, or is to be written.
  Assimp::IOStream* Open(const char* name, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

  /// Paths of all that were opened, each once.
  const std::vector<std::string>& opened() const { return opened_; }

 private:
  std::string path_of(const char* name) const;

  std::string input_;
  std::vector<std::string> opened_;
};

std::string NeighborFiles::path_of(const char* name) const {
  std::string text(name);
  std::ranges::replace(text, '\\', '/');
  return neighbor_path(input_, text).value_or(std::string());
}

bool NeighborFiles::Exists(const char* name) const {
  const std::string path = path_of(name);
  std::error_code ignored;
  return !path.empty() && std::filesystem::is_regular_file(path, ignored);
}

Assimp::IOStream* NeighborFiles::Open(const char* name, const char* mode) {
  const std::string path = path_of(name);
  if (path.empty() || std::strpbrk(mode, "wa+") != nullptr) return nullptr;
  try {
    gltf::Bytes bytes = gltf::read_whole_file(path);
    if (wants_carriage_returns(path)) bytes = with_carriage_returns(bytes);
    auto* file = new LoadedFile(std::move(bytes));
    if (std::ranges::find(opened_, path) == opened_.end()) opened_.push_back(path);
    return file;
  } catch (const Error&) {
    return nullptr;
  }
}

void NeighborFiles::Close(Assimp::IOStream* stream) { delete stream; }

void lower_limit(int resource, rlim_t max) {
  rlimit limit{};
  getrlimit(static_cast<__rlimit_resource>(resource), &limit);
  limit.rlim_cur = std::min(limit.rlim_cur, max);
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
  importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, lower_extension(path) != ".bvh");
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
