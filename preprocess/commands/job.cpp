// mdprep job: one job of a batch, as an engine starts it.
#include <iostream>
#include <memory>

#include "preprocess/batch/job_run.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/commands/source.h"

namespace mdk {
namespace {

struct JobArguments {
  JobRequest request;
  bool quiet = false;
};

void run_job_command(const JobArguments& arguments, CommandContext& context) {
  const JobRequest& request = arguments.request;
  Command line = mdprep_command();
  if (!line.parse(request.command, std::cout)) return;
  const Command& chosen = line.chosen();
  JobCommand command = {chosen.name(), chosen.options_text(OptionScope::kResults)};
  if (const Option* output = chosen.find_option("--output")) command.output = output->text();
  if (const Option* inputs = chosen.find_option("INPUT"))
    command.find_sources = [inputs] { return find_source(inputs->given).files.files; };
  command.run = [&line](CommandContext& of_job) { line.run(of_job); };
  if (run_job(request, command, context.interrupts) == JobResult::kUpToDate && !arguments.quiet)
    std::cerr << "mdprep: " << request.record << ": up to date\n";
}

}  // namespace

void add_job_command(Command& command) {
  const auto arguments = std::make_shared<JobArguments>();
  JobRequest& request = arguments->request;
  command
      .add_texts(OptionKind::kSome, "COMMAND", "",
                 "The job after two dashes: a bake, verify or render with its options.",
                 request.command)
      .required();
  command
      .add_text("--record", "FILE",
                "Where to keep what came of the job (mdprep-job/1). A job whose record says that\n"
                "command, program, inputs and outputs are as they were has nothing to do.",
                request.record)
      .required();
  command.add_texts(
      OptionKind::kOneEach, "--needs", "FILE",
      "Records of jobs that must have succeeded, one for each --needs; else this one\n"
      "does not run, with status 3.",
      request.needs);
  command.add_text("--depfile", "FILE",
                   "Write every file that was read as what the record depends on, for make and\n"
                   "ninja.",
                   request.depfile);
  command.add_flag("-q,--quiet", "Do not tell that there was nothing to do.", arguments->quiet);
  command.set_notes(
      "Makes the folders that outputs need, and leaves an output that comes out as it was alone,\n"
      "its time stamp too. 'mdprep batch' writes such lines for whole lists.\n"
      "Example:\n"
      "  mdprep job --record records/hand.json -- bake hand.glb -o out/hand.mdk --fps 24");
  command.set_body([arguments](CommandContext& context) { run_job_command(*arguments, context); });
}

}  // namespace mdk
