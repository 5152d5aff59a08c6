// mdprep batch: a manifest in, files for engines out; and afterwards what came of it.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <thread>

#include "common/base/error.h"
#include "preprocess/batch/engine_files.h"
#include "preprocess/batch/manifest.h"
#include "preprocess/batch/plan.h"
#include "preprocess/batch/summary.h"
#include "preprocess/cli/commands.h"
#include "preprocess/cli/number_text.h"
#include "preprocess/cli/output_paths.h"
#include "preprocess/cli/text_file.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr CountRange kCoreRange{1, 4096};

struct BatchArguments {
  std::string manifest;
  std::string ninja, make, slurm;
  bool list = false, summary = false;
  std::string only;
  std::string html, json;
  std::string program;
  std::string cores = "all", machine_memory = "all";
};

/// All of them where `text` is empty.
std::vector<JobKind> parse_only(const std::string& text) {
  std::vector<JobKind> kinds(std::begin(kJobKinds), std::end(kJobKinds));
  if (text.empty()) return kinds;
  std::erase_if(kinds, [&](JobKind kind) { return kind_name(kind) != text; });
  if (kinds.empty())
    throw Error(ErrorCode::kUsage, "--only " + text + ": expected bake, verify or render");
  return kinds;
}

std::uint32_t core_count(const std::string& text) {
  if (text != "all") return parse_count("--cores", text, kCoreRange);
  return std::clamp(std::thread::hardware_concurrency(), kCoreRange.lowest, kCoreRange.highest);
}

std::uint64_t machine_memory(const std::string& text) {
  if (text != "all") return parse_size("--machine-memory", text);
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
  options.cores = core_count(arguments.cores);
  options.memory_bytes = machine_memory(arguments.machine_memory);
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
  const std::vector<JobKind> kinds = parse_only(arguments.only);
  const Manifest manifest = read_manifest(arguments.manifest);
  const EngineOptions options = engine_options(arguments, manifest);
  const std::vector<Job> jobs = plan_jobs(manifest);
  write_engine_files(arguments, jobs, options);
  if (arguments.list) std::cout << job_list_text(jobs, kinds, options);
  if (arguments.summary) write_summary(arguments, manifest, jobs);
}

void add_engine_options(CLI::App& command, BatchArguments& arguments) {
  command
      .add_option("--ninja", arguments.ninja,
                  "Write a build.ninja. Run it in the manifest's folder: ninja -f FILE.")
      ->type_name("FILE");
  command
      .add_option("--make", arguments.make,
                  "Write a Makefile for GNU make. Run it in the manifest's folder: make -f FILE.")
      ->type_name("FILE");
  command
      .add_option("--slurm", arguments.slurm,
                  "Write a script that submits job arrays: bash FILE [--wait] [SBATCH-OPTION...].")
      ->type_name("FILE");
  CLI::Option* list = command.add_flag(
      "--list", arguments.list,
      "Print what would run, a line of shell for each job, as GNU parallel takes them; bakes\n"
      "first.");
  command.add_option("--only", arguments.only, "List one kind of job only.")
      ->type_name("bake|verify|render")
      ->needs(list);
  command
      .add_option("--program", arguments.program,
                  "How jobs call mdprep, where nodes have it in another place (default: this one).")
      ->type_name("FILE");
  command
      .add_option("--cores", arguments.cores,
                  "Cores of the machine that ninja runs on (default: all of this one).")
      ->type_name("all|N");
  command
      .add_option(
          "--machine-memory", arguments.machine_memory,
          "Memory of the machine that ninja runs on; the jobs that run at one time declare\n"
          "no more together (default: all of this one).")
      ->type_name("all|SIZE");
}

void add_summary_options(CLI::App& command, BatchArguments& arguments) {
  CLI::Option* summary = command.add_flag(
      "--summary", arguments.summary,
      "Print what came of the jobs: totals, what failed and why, the slowest, the largest.\n"
      "Exit status 3 where a job is not done.");
  command
      .add_option("--html", arguments.html,
                  "Write the summary as one page that needs nothing else.")
      ->type_name("FILE")
      ->needs(summary);
  command.add_option("--json", arguments.json, "Write the summary as JSON (mdprep-batch/1).")
      ->type_name("FILE")
      ->needs(summary);
}

}  // namespace

CommandBody add_batch_command(CLI::App& command) {
  const auto arguments = std::make_shared<BatchArguments>();
  command
      .add_option(
          "MANIFEST", arguments->manifest,
          "A JSON list of bakes, verifies and renders (docs/farm.md has its schema). Paths\n"
          "in it are relative to its folder.")
      ->required()
      ->type_name("");
  add_engine_options(command, *arguments);
  add_summary_options(command, *arguments);
  command.footer(
      "Jobs whose command, program, inputs and outputs are as when they were done do nothing when\n"
      "they are run again, whatever the engine.\n"
      "Example:\n"
      "  mdprep batch walk.json --ninja build.ninja && ninja\n"
      "  mdprep batch walk.json --slurm walk.sh && bash walk.sh --wait --partition=short\n"
      "  mdprep batch walk.json --list --only bake | parallel -j 8\n"
      "  mdprep batch walk.json --summary --html walk.html");
  return [arguments](CommandContext&) { run_batch(*arguments); };
}

}  // namespace mdk
