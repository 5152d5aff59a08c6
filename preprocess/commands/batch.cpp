// mdprep batch: a manifest in, files for engines out; and afterwards what came of it.
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <thread>

#include "common/base/error.h"
#include "preprocess/batch/engine_files.h"
#include "preprocess/batch/plan.h"
#include "preprocess/batch/summary.h"
#include "preprocess/commands/command_line.h"
#include "preprocess/tool/files.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr CountRange kCoreRange{1, 4096};

struct BatchArguments {
  std::string manifest;
  std::string ninja, make, slurm;
  bool list = false, summary = false;
  std::vector<JobKind> only{std::begin(kJobKinds), std::end(kJobKinds)};
  std::string html, json;
  std::string program;
  std::uint32_t cores = 0;
  std::uint64_t memory_bytes = 0;
};

std::vector<JobKind> parse_only(const std::string& text) {
  for (const JobKind kind : kJobKinds)
    if (kind_name(kind) == text) return {kind};
  throw expected("bake, verify or render");
}

std::uint32_t parse_cores(std::string_view text) {
  if (text != "all") return parse_count(text, kCoreRange);
  return std::clamp(std::thread::hardware_concurrency(), kCoreRange.lowest, kCoreRange.highest);
}

std::uint64_t parse_machine_memory(std::string_view text) {
  if (text != "all") return parse_size(text);
  return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

EngineOptions engine_options(const BatchArguments& arguments, const Manifest& manifest) {
  EngineOptions options;
  options.program =
      arguments.program.empty() ? fs::read_symlink("/proc/self/exe").string() : arguments.program;
  options.manifest = fs::path(manifest.path).filename().string();
  options.folder = fs::absolute(manifest.folder).lexically_normal().string();
  options.records = manifest.records;
  options.cores = arguments.cores;
  options.memory_bytes = arguments.memory_bytes;
  return options;
}

void write_engine_files(const BatchArguments& arguments, const std::vector<Job>& jobs,
                        const EngineOptions& options) {
  if (!arguments.ninja.empty()) write_text_file(arguments.ninja, ninja_text(jobs, options));
  if (!arguments.make.empty()) write_text_file(arguments.make, make_text(jobs, options));
  if (!arguments.slurm.empty()) write_text_file(arguments.slurm, slurm_text(jobs, options));
}

void write_summary(const BatchArguments& arguments, const Manifest& manifest,
                   const std::vector<Job>& jobs) {
  const BatchSummary summary = summarize(jobs, manifest.folder);
  print_summary(summary, std::cout);
  if (!arguments.json.empty()) write_text_file(arguments.json, summary_json(summary));
  if (!arguments.html.empty())
    write_text_file(arguments.html,
                    summary_html(summary, fs::path(manifest.path).filename().string()));
  const std::size_t failed = summary.failed().size();
  if (failed > 0)
    throw bad_input(manifest.path, std::to_string(failed) + " of " + std::to_string(jobs.size()) +
                                       " jobs are not done; the table says why");
}

void check_arguments(const BatchArguments& arguments) {
  if (arguments.ninja.empty() && arguments.make.empty() && arguments.slurm.empty() &&
      !arguments.list && !arguments.summary)
    throw Error(ErrorCode::kUsage,
                "mdprep batch runs nothing itself: give --ninja FILE, --make FILE, --slurm FILE, "
                "--list or --summary");
  const std::string outputs[] = {arguments.ninja, arguments.make, arguments.slurm, arguments.html,
                                 arguments.json};
  require_distinct_files(arguments.manifest, outputs);
  for (const std::string& output : outputs)
    if (!output.empty()) require_writable_place(output);
}

void run_batch(const BatchArguments& arguments) {
  check_arguments(arguments);
  const Manifest manifest = read_manifest(arguments.manifest);
  const EngineOptions options = engine_options(arguments, manifest);
  const std::vector<Job> jobs = plan_jobs(manifest, [](const std::vector<std::string>& words) {
    mdprep_command().parse(words, std::cout);
  });
  write_engine_files(arguments, jobs, options);
  if (arguments.list) std::cout << job_list_text(jobs, arguments.only, options);
  if (arguments.summary) write_summary(arguments, manifest, jobs);
}

void add_engine_options(Command& command, BatchArguments& arguments) {
  command.add_text("--ninja", "FILE",
                   "Write a build.ninja. Run it in the manifest's folder: ninja -f FILE.",
                   arguments.ninja);
  command.add_text("--make", "FILE",
                   "Write a Makefile for GNU make. Run it in the manifest's folder: make -f FILE.",
                   arguments.make);
  command.add_text("--slurm", "FILE",
                   "Write a script that submits job arrays: bash FILE [--wait] [SBATCH-OPTION...].",
                   arguments.slurm);
  command.add_flag(
      "--list",
      "Print what would run, a line of shell for each job, as GNU parallel takes them; bakes\n"
      "first.",
      arguments.list);
  command
      .add_value("--only", "bake|verify|render", "List one kind of job only.", "", arguments.only,
                 parse_only)
      .needs = "--list";
  command.add_text(
      "--program", "FILE",
      "How jobs call mdprep, where nodes have it in another place (default: this one).",
      arguments.program);
  command.add_value("--cores", "all|N",
                    "Cores of the machine that ninja runs on (default: all of this one).", "all",
                    arguments.cores, parse_cores);
  command.add_value(
      "--machine-memory", "all|SIZE",
      "Memory of the machine that ninja runs on; the jobs that run at one time declare\n"
      "no more together (default: all of this one).",
      "all", arguments.memory_bytes, parse_machine_memory);
}

void add_summary_options(Command& command, BatchArguments& arguments) {
  command.add_flag(
      "--summary",
      "Print what came of the jobs: totals, what failed and why, the slowest, the largest.\n"
      "Exit status 3 where a job is not done.",
      arguments.summary);
  command
      .add_text("--html", "FILE", "Write the summary as one page that needs nothing else.",
                arguments.html)
      .needs = "--summary";
  command.add_text("--json", "FILE", "Write the summary as JSON (mdprep-batch/1).", arguments.json)
      .needs = "--summary";
}

}  // namespace

void add_batch_command(Command& command) {
  const auto arguments = std::make_shared<BatchArguments>();
  command
      .add_text("MANIFEST", "",
                "A JSON list of bakes, verifies and renders (docs/farm.md has its schema). Paths\n"
                "in it are relative to its folder.",
                arguments->manifest)
      .required();
  add_engine_options(command, *arguments);
  add_summary_options(command, *arguments);
  command.set_notes(
      "Jobs whose command, program, inputs and outputs are as when they were done do nothing when\n"
      "they are run again, whatever the engine.\n"
      "Example:\n"
      "  mdprep batch walk.json --ninja build.ninja && ninja\n"
      "  mdprep batch walk.json --slurm walk.sh && bash walk.sh --wait --partition=short\n"
      "  mdprep batch walk.json --list --only bake | parallel -j 8\n"
      "  mdprep batch walk.json --summary --html walk.html");
  command.set_body([arguments](CommandContext&) { run_batch(*arguments); });
}

}  // namespace mdk
