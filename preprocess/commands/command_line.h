// mdprep's command line and its subcommands, each in a file of its own. The program's own words go
// through it, and those of a job that 'mdprep job' runs.
#pragma once

#include "preprocess/tool/command.h"

namespace mdk {

/// Adds options, notes and body to a freshly made subcommand.
void add_bake_command(Command& command);
void add_info_command(Command& command);
void add_verify_command(Command& command);
void add_render_command(Command& command);
void add_bench_command(Command& command);
void add_batch_command(Command& command);
void add_job_command(Command& command);
void add_scene_command(Command& command);

/// All of mdprep, ready to parse.
Command mdprep_command();

}  // namespace mdk
