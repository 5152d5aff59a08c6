#include "tests/viewer/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace mdk::test {
namespace {

/// What the system tells of a process or thread, from its state on; a name may hold anything.
std::string stat_after_name(const std::filesystem::path& process) {
  std::ifstream in(process / "stat");
  std::string text;
  std::getline(in, text);
  return text.substr(std::min(text.rfind(')') + 1, text.size()));
}

void redirect(const std::string& file, int to) {
  const char* path = file.empty() ? "/dev/null" : file.c_str();
  const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (fd >= 0) dup2(fd, to);
}

}  // namespace

ChildProcess::ChildProcess(const ChildSetup& setup, int inherited_fd) {
  pid_ = fork();
  if (pid_ < 0) throw std::runtime_error("cannot fork");
  if (pid_ > 0) return;
  if (inherited_fd >= 0) fcntl(inherited_fd, F_SETFD, 0);
  redirect(setup.stdout_file, STDOUT_FILENO);
  redirect(setup.stderr_file, STDERR_FILENO);
  if (setup.display)
    setenv("DISPLAY", setup.display->c_str(), 1);
  else
    unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  // In sanitised builds: the OpenGL driver keeps memory until the process ends, and is not ours.
  setenv("ASAN_OPTIONS", "detect_leaks=0", 0);
  if (!setup.folder.empty() && chdir(setup.folder.c_str()) != 0) _exit(126);
  std::vector<char*> words;
  for (const std::string& word : setup.command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  execvp(words[0], words.data());
  _exit(127);
}

ChildProcess::~ChildProcess() {
  if (status_) return;
  kill(pid_, SIGTERM);
  if (!wait(5)) {
    kill(pid_, SIGKILL);
    wait(5);
  }
}

bool ChildProcess::running() { return !wait(0); }

std::optional<int> ChildProcess::wait(double seconds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!status_) {
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_)
      status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    else if (std::chrono::steady_clock::now() >= end)
      break;
    else
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return status_;
}

double ChildProcess::cpu_seconds() const {
  std::istringstream fields(stat_after_name("/proc/" + std::to_string(pid_)));
  std::string skipped;
  for (int field = 3; field < 14; ++field) fields >> skipped;  // state is the third
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

bool ChildProcess::asleep() const {
  std::error_code gone;
  const std::string threads = "/proc/" + std::to_string(pid_) + "/task";
  for (std::filesystem::directory_iterator at(threads, gone), end; !gone && at != end;
       at.increment(gone))
    if (stat_after_name(at->path()).starts_with(" R")) return false;
  return true;
}

bool has_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (access((folder + "/" + name).c_str(), X_OK) == 0) return true;
  return false;
}

}  // namespace mdk::test
