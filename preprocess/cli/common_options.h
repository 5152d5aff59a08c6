// Options that mean the same in every subcommand: --threads, --isa and --memory-limit, -q and
// --progress, -v.
#pragma once

#include <string>

#include "common/base/parallel.h"
#include "preprocess/cli/memory_limit.h"
#include "preprocess/cli/progress_bar.h"

namespace CLI {
class App;
}

namespace mdk {

struct MachineOptions {
  std::string threads = "all";
  std::string isa = "best";
  std::string memory_limit = "none";
};
void add_machine_options(CLI::App& command, MachineOptions& options);

/// Holds the process to the threads, the instruction set and the memory that were asked for while
/// it lives. Throws Error: kUsage, or kOverLimit for memory that cannot be enough.
class MachineLimits {
 public:
  explicit MachineLimits(const MachineOptions& options);
  const MemoryLimit& memory() const { return memory_; }

 private:
  ThreadLimit threads_;
  MemoryLimit memory_;
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
