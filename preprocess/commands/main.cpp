// mdprep: runs one subcommand, and turns whatever goes wrong into one sentence on stderr and an
// exit status.
#include <csignal>
#include <exception>
#include <iostream>

#include "common/base/error.h"
#include "formats/files/mapped_file.h"
#include "preprocess/commands/command_line.h"

namespace mdk {
namespace {

void parse_and_run(int argc, char** argv) {
  Command mdprep = mdprep_command();
  if (!mdprep.parse({argv + 1, argv + argc}, std::cout)) return;
  Interrupts interrupts;
  CommandContext context{interrupts};
  mdprep.run(context);
}

/// A full disk or a closed pipe must not pass for success.
void require_stdout_written() {
  if (!std::cout.flush()) throw io_error("standard output", "cannot be written");
}

int run(int argc, char** argv) {
  try {
    parse_and_run(argc, argv);
    require_stdout_written();
    return 0;
  } catch (...) {
    const Failure failure = describe_failure(std::current_exception());
    std::cout.flush();
    std::cerr << "mdprep: " << failure.sentence << "\n";
    return failure.status;
  }
}

}  // namespace
}  // namespace mdk

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error to report, not the end
  mdk::name_lost_mappings();
  return mdk::run(argc, argv);
}
