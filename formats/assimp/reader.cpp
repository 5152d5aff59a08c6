// Of the library: one run of mdk-assimp, and what the reader of glTF makes of its answer.
#include "formats/assimp/reader.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <new>
#include <span>
#include <string_view>
#include <thread>

#include "common/base/error.h"
#include "formats/assimp/answer.h"
#include "formats/files/file_kind.h"
#include "formats/gltf/reader.h"

extern char** environ;

namespace mdk {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(5);
constexpr int kLooksBetweenReports = 20;

Error cannot_start(int failure) {
  return {ErrorCode::kIo, std::string(kAssimpProgram) +
                              ", which reads such files, cannot be started: " +
                              std::strerror(failure) + "; put it beside mdprep"};
}

/// Beside this program, or where an installation has programs that people do not start.
std::string program() {
  std::error_code failure;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", failure).parent_path();
  const auto beside = folder / kAssimpProgram;
  if (::access(beside.c_str(), X_OK) == 0) return beside.string();
  return (folder.parent_path() / "libexec" / "mdk" / kAssimpProgram).string();
}

/// A file in memory that a process writes and another reads afterwards.
class MemoryFile {
 public:
  explicit MemoryFile(const char* name) : file_(::memfd_create(name, MFD_CLOEXEC)) {
    if (file_ < 0) throw cannot_start(errno);
  }
  ~MemoryFile() {
    if (bytes_ != nullptr) ::munmap(bytes_, size_);
    ::close(file_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  int number() const { return file_; }

  /// All that was written; once, when nobody writes any more.
  std::span<const unsigned char> bytes() {
    struct stat state {};
    if (::fstat(file_, &state) != 0 || state.st_size == 0) return {};
    size_ = static_cast<std::size_t>(state.st_size);
    void* mapped = ::mmap(nullptr, size_, PROT_READ, MAP_SHARED, file_, 0);
    if (mapped == MAP_FAILED) throw std::bad_alloc();
    bytes_ = mapped;
    return {static_cast<const unsigned char*>(bytes_), size_};
  }

 private:
  int file_;
  void* bytes_ = nullptr;
  std::size_t size_ = 0;
};

class Process {
 public:
  Process(const std::string& path, const MemoryFile& answer, const MemoryFile& messages) {
    std::string words[] = {program(), path};
    char* argv[] = {words[0].data(), words[1].data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, answer.number(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, messages.number(), STDERR_FILENO);
    const int failure = posix_spawn(&pid_, argv[0], &actions, nullptr, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failure != 0) throw cannot_start(failure);
  }
  ~Process() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Its status, as waitpid has it.
  int wait(ProgressSink& progress) {
    int status = 0;
    for (int looks = 0;; ++looks) {
      const pid_t ended = ::waitpid(pid_, &status, WNOHANG);
      if (ended == pid_) break;
      if (ended < 0 && errno != EINTR) throw cannot_start(errno);
      if (looks % kLooksBetweenReports == 0) progress.report("read", 0);
      std::this_thread::sleep_for(kBetweenLooks);
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
};

/// What it last said of its own, without its name; Assimp may have said things, too.
std::string last_sentence(std::span<const unsigned char> messages) {
  std::string_view text(reinterpret_cast<const char*>(messages.data()), messages.size());
  const std::string start = std::string(kAssimpProgram) + ": ";
  const std::size_t at = text.rfind(start);
  if (at == text.npos) return {};
  text.remove_prefix(at + start.size());
  return std::string(text.substr(0, text.find('\n')));
}

Error failure_of(const std::string& path, int status, const std::string& sentence) {
  if (WIFEXITED(status) && !sentence.empty())
    return {static_cast<ErrorCode>(WEXITSTATUS(status)), sentence};
  const int signal_number = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (signal_number == SIGXCPU)
    return {ErrorCode::kOverLimit,
            path + ": takes Assimp over ten minutes of work; export it as glTF"};
  if (signal_number == SIGKILL || signal_number == SIGXFSZ)
    return {ErrorCode::kOverLimit,
            path + ": takes Assimp more memory than there is; export it as glTF"};
  return bad_input(path,
                   "makes Assimp crash" +
                       (signal_number == 0 ? std::string()
                                           : " (" + std::string(::strsignal(signal_number)) + ")") +
                       "; export it again, or as glTF");
}

/// Runs mdk-assimp on the file and waits. `progress` is asked for leave several times a second:
/// what it throws ends the run. Throws Error: its own sentence and code where it gives one;
/// kBadInput where the file makes it crash, kOverLimit where it ran out of time, kIo where it is
/// not there.
AssimpAnswer run_assimp(const std::string& path, ProgressSink& progress) {
  MemoryFile answer("answer"), messages("messages");
  const int status = Process(path, answer, messages).wait(progress);
  if (status == 0) return parse_assimp_answer(answer.bytes());
  progress.report("read", 0);  // Ctrl-C ends both: then this is the one to say so
  throw failure_of(path, status, last_sentence(messages.bytes()));
}

}  // namespace

ReadResult read_with_assimp(const std::string& path, const ReadOptions& options,
                            ProgressSink& progress) {
  if (!has_assimp())
    throw bad_input(path,
                    "is read through Assimp, which this build is without; build it where "
                    "libassimp-dev is installed, or export the mesh as glTF");
  const AssimpAnswer answer = run_assimp(path, progress);
  ReadResult result = read_glb(path, answer.glb, options, progress);
  result.read_through = "Assimp " + answer.version;
  result.notes.insert(result.notes.begin(), answer.notes.begin(), answer.notes.end());
  result.notes.insert(result.notes.begin(), path + " was read through " + result.read_through +
                                                ", not by a reader of this program's own");
  result.dependencies.insert(result.dependencies.begin(), answer.files.begin(), answer.files.end());
  return result;
}

}  // namespace mdk
