// mdprep job: one job of a batch, as an engine starts it.
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "preprocess/batch/job_run.h"
#include "preprocess/cli/commands.h"

namespace mdk {

CommandBody add_job_command(CLI::App& command) {
  const auto request = std::make_shared<JobRequest>();
  const auto quiet = std::make_shared<bool>(false);
  command
      .add_option("COMMAND", request->command,
                  "The job after two dashes: a bake, verify or render with its options.")
      ->required()
      ->expected(1, -1)
      ->type_name("");
  command
      .add_option(
          "--record", request->record,
          "Where to keep what came of the job (mdprep-job/1). A job whose record says that\n"
          "command, program, inputs and outputs are as they were has nothing to do.")
      ->required()
      ->type_name("FILE");
  command
      .add_option("--needs", request->needs,
                  "Records of jobs that must have succeeded, one for each --needs; else this one\n"
                  "does not run, with status 3.")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command
      .add_option("--depfile", request->depfile,
                  "Write every file that was read as what the record depends on, for make and\n"
                  "ninja.")
      ->type_name("FILE");
  command.add_flag("-q,--quiet", *quiet, "Do not tell that there was nothing to do.");
  command.footer(
      "Makes the folders that outputs need, and leaves an output that comes out as it was alone,\n"
      "its time stamp too. 'mdprep batch' writes such lines for whole lists.\n"
      "Example:\n"
      "  mdprep job --record records/hand.json -- bake hand.glb -o out/hand.mdk --fps 24");
  return [request, quiet](CommandContext&) {
    const JobResult result = run_job(*request);
    if (result == JobResult::kUpToDate && !*quiet)
      std::cerr << "mdprep: " << request->record << ": up to date\n";
  };
}

}  // namespace mdk
