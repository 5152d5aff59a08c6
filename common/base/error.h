// Error: the one exception type. Thrown at the edge where something is wrong, caught once in main.
#pragma once

#include <stdexcept>
#include <string>

namespace mdk {

/// Doubles as the process exit status.
enum class ErrorCode : int {
  kInternal = 1,   ///< a bug in this program
  kUsage = 2,      ///< wrong use of the command line
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

/// "walk.glb: accessor 3 reaches past its buffer view": the file, then the sentence.
inline Error bad_input(const std::string& file, const std::string& sentence) {
  return {ErrorCode::kBadInput, file + ": " + sentence};
}
inline Error io_error(const std::string& file, const std::string& sentence) {
  return {ErrorCode::kIo, file + ": " + sentence};
}

}  // namespace mdk
