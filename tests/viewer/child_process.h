// ChildProcess: a program started for a test, with its own environment and its output in files.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

namespace mdk::test {

struct ChildSetup {
  std::vector<std::string> command;      ///< program (found along PATH) and its words
  std::optional<std::string> display;    ///< DISPLAY of the child; none: it has none
  std::string stdout_file, stderr_file;  ///< empty: nowhere
  std::string folder;                    ///< where it starts; empty: here
};

class ChildProcess {
 public:
  /// `inherited_fd`: a descriptor the child keeps under its number, or -1.
  explicit ChildProcess(const ChildSetup& setup, int inherited_fd = -1);
  /// Ends the child if it still runs.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  bool running();
  /// Processor time it has taken so far, in seconds, all of its threads.
  double cpu_seconds() const;
  /// Whether all of its threads wait for something.
  bool asleep() const;
  /// Its exit status, or 128 + the signal that ended it; empty where it still runs after `seconds`.
  std::optional<int> wait(double seconds);

 private:
  pid_t pid_ = -1;
  std::optional<int> status_;
};

/// Whether PATH has such a program.
bool has_program(const std::string& name);

}  // namespace mdk::test
