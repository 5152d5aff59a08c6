// Options that mean the same in every subcommand: --threads and --isa, -q and --progress, -v.
#pragma once

#include <string>

#include "common/base/parallel.h"
#include "preprocess/cli/progress_bar.h"

namespace CLI {
class App;
}

namespace mdk {

struct MachineOptions {
  std::string threads = "all";
  std::string isa = "best";
};
void add_machine_options(CLI::App& command, MachineOptions& options);

/// Holds the process to the threads and the instruction set that were asked for while it lives.
/// Throws Error (kUsage).
class MachineLimits {
 public:
  explicit MachineLimits(const MachineOptions& options);

 private:
  ThreadLimit threads_;
};

struct MessageOptions {
  bool quiet = false;
  bool verbose = false;
  std::string progress = "auto";
};
void add_message_options(CLI::App& command, MessageOptions& options);
/// Only for subcommands that have more to tell.
void add_verbose_option(CLI::App& command, MessageOptions& options);

/// What --progress and -q come to, stderr being a terminal or not. Throws Error (kUsage).
ProgressStyle progress_style(const MessageOptions& options);

}  // namespace mdk
