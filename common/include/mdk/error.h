// Error: the one exception type that the library throws on purpose.
#pragma once

#include <stdexcept>
#include <string>

namespace mdk {

/// Doubles as the process exit status.
enum class ErrorCode : int {
  kInternal = 1,   ///< a bug in this program
  kUsage = 2,      ///< wrong use of a function or of the command line
  kBadInput = 3,   ///< a file's content cannot be used
  kIo = 4,         ///< a file cannot be read or written
  kOverLimit = 5,  ///< over a limit that was set or is built in
};

/// `what()` is one sentence that names file, place and cure, without a final newline.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& sentence) : std::runtime_error(sentence), code_(code) {}
  ErrorCode code() const { return code_; }
  int exit_status() const { return static_cast<int>(code_); }

 private:
  ErrorCode code_;
};

}  // namespace mdk
