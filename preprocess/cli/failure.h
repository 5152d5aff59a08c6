// Failure: what is left of an exception for people and scripts, a sentence and an exit status.
#pragma once

#include <exception>
#include <string>

namespace mdk {

struct Failure {
  int status = 0;
  std::string sentence;
};

/// Of anything that can be thrown here: Error, Interrupted, std::bad_alloc, or a fault of our own.
Failure describe_failure(const std::exception_ptr& thrown);

}  // namespace mdk
