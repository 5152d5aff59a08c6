// CommandLine: mdprep's command line, parsed and ready to run. The program's own words go through
// it, and those of a job that 'mdprep job' runs.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "preprocess/cli/command_context.h"
#include "preprocess/cli/option_text.h"

namespace mdk {

class CommandLine {
 public:
  CommandLine();
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Words after the program's name. Once. False where they only ask for help or the version, which
  /// is printed. Throws Error (kUsage).
  bool parse(const std::vector<std::string>& words);

  /// The subcommand's name.
  std::string name() const;
  std::string option_text(OptionScope scope) const;

  /// Runs the subcommand. Throws Error, or Interrupted after Ctrl-C.
  void run(CommandContext& context) const;

  /// For manual pages and completion.
  const CLI::App& app() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mdk
