#include "viewer/scene/mdprep_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>

#include "common/base/error.h"

extern char** environ;

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr int kNiceness = 5;  // the picture comes first

std::string mdprep_program() {
  std::error_code failure;
  const auto self = fs::read_symlink("/proc/self/exe", failure);
  const auto beside = self.parent_path() / "mdprep";
  return !failure && ::access(beside.c_str(), X_OK) == 0 ? beside.string() : "mdprep";
}

/// Its stdout goes nowhere, its stderr to `messages`. Returns errno.
int spawn(std::vector<std::string> words, int messages, pid_t& pid) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
  const int failure = posix_spawnp(&pid, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return failure;
}

Error failure_of(int status, const std::string& sentence) {
  if (WIFEXITED(status) && !sentence.empty())
    return {static_cast<ErrorCode>(WEXITSTATUS(status)), sentence};
  return {ErrorCode::kInternal, "mdprep ended before its work was done"};
}

}  // namespace

std::optional<MdprepProgress> parse_mdprep_progress(std::string_view line) {
  constexpr std::string_view kClearLine = "\x1b[K";
  if (line.starts_with(kClearLine)) line.remove_prefix(kClearLine.size());
  const std::size_t bar_end = line.find("] ");
  if (!line.starts_with('[') || bar_end == line.npos) return {};
  line.remove_prefix(bar_end + 2);
  const std::size_t digits = std::min(line.find_first_not_of(' '), line.size());
  int percent = 0;
  const auto [end, failure] =
      std::from_chars(line.data() + digits, line.data() + line.size(), percent);
  if (failure != std::errc{}) return {};
  return MdprepProgress{std::clamp(percent / 100.0, 0.0, 1.0), std::string(line)};
}

MdprepProcess::MdprepProcess(const std::string& subcommand,
                             const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {mdprep_program(), subcommand, "--progress", "always"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0)
    throw Error(ErrorCode::kIo, std::string("mdprep cannot be started: ") + std::strerror(errno));
  const int failure = spawn(std::move(words), ends[1], pid_);
  ::close(ends[1]);
  messages_ = ends[0];
  if (failure == 0) {
    ::setpriority(PRIO_PROCESS, static_cast<id_t>(pid_), kNiceness);
    return;
  }
  ::close(messages_);
  throw Error(ErrorCode::kIo, std::string("mdprep, which bakes and renders, cannot be started: ") +
                                  std::strerror(failure) + "; put it beside mdview");
}

MdprepProcess::~MdprepProcess() {
  kill();
  ::close(messages_);
  if (pid_ > 0) ::waitpid(pid_, nullptr, 0);
}

std::optional<MdprepProgress> MdprepProcess::take_line(std::string_view line) {
  auto progress = parse_mdprep_progress(line);
  constexpr std::string_view kName = "mdprep: ";
  if (const std::size_t at = line.find(kName); !progress && at != line.npos)
    sentence_ = line.substr(at + kName.size());
  return progress;
}

std::optional<MdprepProgress> MdprepProcess::next_progress() {
  std::array<char, 4096> bytes{};
  while (true) {
    const ssize_t count = ::read(messages_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      take_line(unread_);
      return {};
    }
    unread_.append(bytes.data(), static_cast<std::size_t>(count));
    // A bar is drawn after "\r" and has no end of its own: the last piece may be whole.
    std::optional<MdprepProgress> latest;
    for (std::size_t end; (end = unread_.find_first_of("\r\n")) != unread_.npos;) {
      if (auto progress = take_line(std::string_view(unread_).substr(0, end))) latest = progress;
      unread_.erase(0, end + 1);
    }
    if (auto progress = parse_mdprep_progress(unread_)) latest = progress;
    if (latest) return latest;
  }
}

void MdprepProcess::finish() {
  int status = 0;
  {
    const std::lock_guard lock(mutex_);
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) continue;
    pid_ = -1;
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw failure_of(status, sentence_);
}

void MdprepProcess::kill() { send(SIGKILL); }
void MdprepProcess::stop() { send(SIGTERM); }

void MdprepProcess::send(int signal_number) {
  const std::lock_guard lock(mutex_);
  if (pid_ > 0) ::kill(pid_, signal_number);
}

TemporaryFolder::TemporaryFolder() : path_((fs::temp_directory_path() / "mdview-XXXXXX").string()) {
  if (!::mkdtemp(path_.data()))
    throw Error(ErrorCode::kIo, path_ + ": cannot be made: " + std::strerror(errno));
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string TemporaryFolder::file(const std::string& name) const {
  return (fs::path(path_) / name).string();
}

}  // namespace mdk
