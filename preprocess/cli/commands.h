// The subcommands of mdprep: each file adds its options to the command line and hands back what to
// run once the line has been parsed.
#pragma once

#include <functional>

#include "preprocess/cli/command_context.h"

namespace CLI {
class App;
}

namespace mdk {

/// Runs a parsed subcommand. Throws Error, or Interrupted after Ctrl-C.
using CommandBody = std::function<void(CommandContext&)>;

/// Each takes its own, freshly made subcommand.
CommandBody add_bake_command(CLI::App& command);
CommandBody add_info_command(CLI::App& command);
CommandBody add_verify_command(CLI::App& command);
CommandBody add_render_command(CLI::App& command);
CommandBody add_bench_command(CLI::App& command);
CommandBody add_batch_command(CLI::App& command);
CommandBody add_job_command(CLI::App& command);

}  // namespace mdk
