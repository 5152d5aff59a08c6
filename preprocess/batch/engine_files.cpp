// Quoting, and the files of ninja, make and whatever runs lines of shell.
//
// ninja has two pools: light jobs, of which every core may run one within half the memory, and
// heavy ones, which share what is then left, each counted as the largest. So no mixture of jobs
// takes more memory than there is.
//
// make knows time stamps only. A record is new after every question, an output after every change:
// so the record is what a job makes, and outputs hang on it with an empty recipe, after which make
// looks at their own time stamps.
#include "preprocess/batch/engine_files.h"

#include <algorithm>
#include <string_view>

#include "common/base/error.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

constexpr std::string_view kPlain =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";

std::string with_prefixed(const std::string& text, std::string_view special, char prefix) {
  std::string result;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) result += prefix;
    result += c;
  }
  return result;
}

/// " a b", each as `written` has it.
std::string joined(std::span<const std::string> names,
                   std::string (*written)(const std::string& name)) {
  std::string text;
  for (const std::string& name : names) text.append(" ").append(written(name));
  return text;
}

struct Pools {
  std::uint64_t max_light_memory = 0;  ///< bytes: jobs that declare no more are light
  std::uint64_t light_depth = 1, heavy_depth = 1;
};

struct Needs {
  std::uint64_t memory = 0;
  std::uint32_t threads = 1;

  void add(const Job& job) {
    memory = std::max(memory, job.memory_bytes);
    threads = std::max(threads, job.threads);
  }
};

std::uint64_t at_least_one(std::uint64_t n) { return std::max<std::uint64_t>(n, 1); }

Pools choose_pools(std::span<const Job> jobs, const EngineOptions& options) {
  Needs all, light, heavy;
  for (const Job& job : jobs) {
    if (job.memory_bytes > options.memory_bytes)
      throw Error(ErrorCode::kOverLimit, job.place + ": a job declares " +
                                             bytes_text(job.memory_bytes) + ", this machine has " +
                                             bytes_text(options.memory_bytes) +
                                             "; declare less, or give --machine-memory");
    all.add(job);
  }
  Pools pools;
  const bool all_fit = all.memory * options.cores <= options.memory_bytes;
  pools.max_light_memory = all_fit ? all.memory : options.memory_bytes / 2 / options.cores;
  for (const Job& job : jobs) (job.memory_bytes <= pools.max_light_memory ? light : heavy).add(job);
  pools.light_depth = at_least_one(options.cores / light.threads);
  if (heavy.memory == 0) return pools;
  const std::uint64_t left = options.memory_bytes - light.memory * pools.light_depth;
  pools.heavy_depth =
      at_least_one(std::min<std::uint64_t>(left / heavy.memory, options.cores / heavy.threads));
  return pools;
}

/// Files that other jobs make come first among the inputs, so that ninja runs those before.
std::string build_text(const Job& job, std::span<const Job> jobs, const EngineOptions& options,
                       const Pools& pools) {
  std::string text = "build" + joined(job.outputs, ninja_path) +
                     (job.outputs.empty() ? " " : " | ") + ninja_path(job.record) + ": " +
                     kind_name(job.kind) + joined(job.inputs, ninja_path) + " | $mdprep\n";
  text +=
      "  line = " + dollars_doubled(shell_line(job_words(job, jobs, options, JobMessages::kNone))) +
      "\n";
  text += "  record = " + dollars_doubled(job.record) + "\n";
  return text + "  pool = " + (job.memory_bytes <= pools.max_light_memory ? "light" : "heavy") +
         "\n";
}

std::string phony_text(std::string_view name, std::span<const Job> jobs, JobKind kind) {
  std::string text = "build " + std::string(name) + ": phony";
  for (const Job& job : jobs)
    if (job.kind == kind) text.append(" ").append(ninja_path(job.record));
  return text + "\n";
}

std::string rule_text(const Job& job, std::span<const Job> jobs, const EngineOptions& options) {
  const std::string record = make_path(job.record);
  std::string text = record + ":" + joined(job.inputs, make_path) + " $(MDPREP)";
  for (const std::string& output : job.outputs)
    text += " $(if $(wildcard " + make_path(output) + "),,missing)";
  text += "\n\t@" + dollars_doubled(shell_line(job_words(job, jobs, options, JobMessages::kNone))) +
          "\n";
  if (!job.outputs.empty())
    text += joined(job.outputs, make_path).substr(1) + ": " + record + " ;\n";
  return text + "-include " + record + ".d\n\n";
}

}  // namespace

std::string shell_word(const std::string& word) {
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string shell_line(std::span<const std::string> words) {
  return words.empty() ? "" : joined(words, shell_word).substr(1);
}

std::string ninja_path(const std::string& path) { return with_prefixed(path, "$ :", '$'); }

std::string dollars_doubled(const std::string& text) { return with_prefixed(text, "$", '$'); }

std::string make_path(const std::string& path) {
  if (path.find_first_of("\\:;=*?[~'\"`()<>|&") != std::string::npos)
    throw Error(ErrorCode::kUsage, path +
                                       ": make cannot hold this name as a target; rename it, or "
                                       "use --ninja");
  return with_prefixed(with_prefixed(path, " #%", '\\'), "$", '$');
}

std::vector<std::string> job_words(const Job& job, std::span<const Job> jobs,
                                   const EngineOptions& options, JobMessages messages) {
  std::vector<std::string> words = {options.program, "job", "--record=" + job.record,
                                    "--depfile=" + job.record + ".d"};
  for (const std::size_t needed : job.needs) words.push_back("--needs=" + jobs[needed].record);
  if (messages == JobMessages::kNone) words.emplace_back("-q");
  words.emplace_back("--");
  words.insert(words.end(), job.command.begin(), job.command.end());
  words.push_back("--threads=" + std::to_string(job.threads));
  words.push_back("--memory-limit=" + size_text(job.memory_bytes));
  words.emplace_back(messages == JobMessages::kNone ? "-q" : "--progress=plain");
  return words;
}

std::string job_list_text(std::span<const Job> jobs, std::span<const JobKind> kinds,
                          const EngineOptions& options) {
  std::string text;
  for (const Job& job : jobs)
    if (std::find(kinds.begin(), kinds.end(), job.kind) != kinds.end())
      text += shell_line(job_words(job, jobs, options, JobMessages::kNone)) + "\n";
  return text;
}

std::string ninja_text(std::span<const Job> jobs, const EngineOptions& options) {
  const Pools pools = choose_pools(jobs, options);
  std::string text = "# From " + options.manifest +
                     " by mdprep batch. Run ninja in the manifest's folder.\n"
                     "ninja_required_version = 1.7\n"
                     "builddir = " +
                     dollars_doubled(options.records) +
                     "\nmdprep = " + dollars_doubled(options.program) +
                     "\n\npool light\n  depth = " + std::to_string(pools.light_depth) +
                     "\npool heavy\n  depth = " + std::to_string(pools.heavy_depth) + "\n\n";
  for (const JobKind kind : kJobKinds)
    text += "rule " + std::string(kind_name(kind)) +
            "\n  command = $line\n  depfile = $record.d\n  deps = gcc\n  restat = 1\n"
            "  description = " +
            kind_name(kind) + " $record\n";
  text += "\n";
  for (const Job& job : jobs) text += build_text(job, jobs, options, pools);
  text += "\n";
  text += phony_text("bakes", jobs, JobKind::kBake);
  text += phony_text("verifies", jobs, JobKind::kVerify);
  text += phony_text("renders", jobs, JobKind::kRender);
  return text + "build all: phony bakes verifies renders\ndefault all\n";
}

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
