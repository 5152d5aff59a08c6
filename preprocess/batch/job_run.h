// Runs one job of a batch: decides by content whether it is needed at all, and leaves a record of
// what came of it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "preprocess/tool/command.h"

namespace mdk {

struct JobRequest {
  std::vector<std::string> command;  ///< words after "mdprep": a bake, verify or render
  std::string record;                ///< file that tells what came of it
  std::vector<std::string> needs;    ///< records of jobs that must have succeeded
  std::string depfile;               ///< for make and ninja; empty: none
};

/// The command of a job, parsed by whoever knows mdprep's command line.
struct JobCommand {
  std::string name;          ///< "bake"
  std::string options_text;  ///< Command::options_text() for kResults
  std::string output = {};   ///< what it writes, as on the command line; empty: nothing

  /// The files that a bake's inputs stand for now; empty: those of others do not change in number.
  /// Throws Error.
  std::function<std::vector<std::string>()> find_sources = {};

  std::function<void(CommandContext&)> run = {};
};

enum class JobResult {
  kRan,
  kUpToDate,  ///< same command, program, inputs and outputs as when it was done last
};

/// Makes the folders of its outputs. The record says "started" while the job runs, so that one that
/// was killed can be told from one that never ran; what such a one left half-written is removed.
/// Outputs that come out as they were keep their time stamps. Throws what the command throws, after
/// noting it in the record, and Error: kUsage for a command that is no job, kBadInput where a
/// needed job did not succeed. Any number of jobs may share a folder; two of the same job do the
/// work twice.
JobResult run_job(const JobRequest& request, const JobCommand& command, Interrupts& interrupts);

}  // namespace mdk
