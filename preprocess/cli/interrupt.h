// Ctrl-C, turned into an exception at a safe place: files are written under a temporary name that
// only unwinding removes.
#pragma once

#include <exception>

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

/// Throws Interrupted where a remembered signal waits.
void throw_if_interrupted();

/// From now on the first SIGINT or SIGTERM is only remembered, and a second one ends the process.
/// While it lives, parallel loops look for it and throw Interrupted.
class DeferredInterrupts {
 public:
  DeferredInterrupts();

 private:
  LoopCheck loops_;
};

}  // namespace mdk
