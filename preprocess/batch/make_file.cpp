// make knows time stamps only. A record is new after every question, an output after every change:
// so the record is what a job makes, and outputs hang on it with an empty recipe, after which make
// looks at their own time stamps.
#include "preprocess/batch/engine_files.h"
#include "preprocess/batch/quoting.h"

namespace mdk {
namespace {

std::string paths(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text.append(" ").append(make_path(name));
  return text;
}

std::string rule_text(const Job& job, std::span<const Job> jobs, const EngineOptions& options) {
  const std::string record = make_path(job.record);
  std::string text = record + ":" + paths(job.inputs) + " $(MDPREP)";
  for (const std::string& output : job.outputs)
    text += " $(if $(wildcard " + make_path(output) + "),,missing)";
  text +=
      "\n\t@" + make_recipe(shell_line(job_words(job, jobs, options, JobMessages::kNone))) + "\n";
  if (!job.outputs.empty()) text += paths(job.outputs).substr(1) + ": " + record + " ;\n";
  return text + "-include " + record + ".d\n\n";
}

}  // namespace

std::string make_text(std::span<const Job> jobs, const EngineOptions& options) {
  std::string text = "# From " + options.manifest +
                     " by mdprep batch. Run GNU make in the manifest's folder.\n"
                     "MDPREP := " +
                     make_path(options.program) +
                     "\n.PHONY: all bakes verifies renders missing\n"
                     "all: bakes verifies renders\n";
  constexpr const char* kTargets[] = {"bakes:", "verifies:", "renders:"};
  for (const JobKind kind : kJobKinds) {
    text += kTargets[static_cast<std::size_t>(kind)];
    for (const Job& job : jobs)
      if (job.kind == kind) text.append(" ").append(make_path(job.record));
    text += "\n";
  }
  text += "\n";
  for (const Job& job : jobs) text += rule_text(job, jobs, options);
  return text;
}

}  // namespace mdk
