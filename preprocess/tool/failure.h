// How a command ends before its time: an exception that main() turns into a sentence and an exit
// status, or Ctrl-C, which becomes an exception at a safe place: files are written under a
// temporary name that only unwinding removes.
#pragma once

#include <exception>
#include <string>

#include "common/base/parallel.h"

namespace mdk {

/// The user asked to stop. Not an Error: nothing is wrong.
class Interrupted final : public std::exception {
 public:
  explicit Interrupted(int signal_number) : signal_number_(signal_number) {}
  const char* what() const noexcept override { return "interrupted"; }
  /// As shells have it: 130 after SIGINT, 143 after SIGTERM.
  int exit_status() const { return 128 + signal_number_; }

 private:
  int signal_number_;
};

/// SIGINT and SIGTERM of the program. Its main() makes one and hands it down to what it runs.
class Interrupts {
 public:
  /// From now on the first signal is only remembered, and a second one ends the process. While the
  /// result lives, parallel loops of this thread and progress bars throw Interrupted after it.
  [[nodiscard]] LoopCheck defer();
};

/// What is left of an exception for people and scripts.
struct Failure {
  int status = 0;
  std::string sentence;
};

/// Of anything that can be thrown here: Error, Interrupted, std::bad_alloc, or a fault of our own.
Failure describe_failure(const std::exception_ptr& thrown);

}  // namespace mdk
