// Runs the real mdprep and keeps what it said.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "tests/formats/temp_folder.h"

namespace mdk::test {

struct Outcome {
  int status = -1;  ///< exit status, or 1000 + signal where a signal ended it
  std::string out, err;
};

/// A started mdprep.
class ProgramRun {
 public:
  explicit ProgramRun(const std::vector<std::string>& arguments);
  /// What stderr holds so far.
  std::string err_so_far() const { return read_text(logs_.file("err")); }
  void send_signal(int signal_number) const;
  /// Whether a file of this name is mapped by it now.
  bool maps(const std::string& path) const;
  Outcome wait();

 private:
  TempFolder logs_;
  pid_t process_ = -1;
};

Outcome run_mdprep(const std::vector<std::string>& arguments);

/// Whether `err` is what a failure looks like: one line that starts with "mdprep: ".
bool is_one_sentence(const std::string& err);

}  // namespace mdk::test
