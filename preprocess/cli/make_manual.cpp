// mdprep_manual FOLDER: writes mdprep's manual pages and bash completion there. Runs while the
// project is built, and is not installed.
#include <iostream>

#include "preprocess/cli/command_line.h"
#include "preprocess/cli/failure.h"
#include "preprocess/cli/manual.h"
#include "preprocess/cli/text_file.h"
#include "preprocess/cli/tool_version.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: mdprep_manual FOLDER\n";
    return 2;
  }
  try {
    const std::string folder = argv[1];
    const mdk::CommandLine line;
    const std::string version = mdk::version_text(mdk::tool_version());
    for (const mdk::ManualPage& page : mdk::manual_pages(line.app(), version))
      mdk::write_text_file(folder + "/" + page.name, page.text);
    mdk::write_text_file(folder + "/mdprep.bash", mdk::bash_completion(line.app()));
    return 0;
  } catch (...) {
    const mdk::Failure failure = mdk::describe_failure(std::current_exception());
    std::cerr << "mdprep_manual: " << failure.sentence << "\n";
    return failure.status;
  }
}
