// Two pools: light jobs, of which every core may run one within half the memory, and heavy ones,
// which share what is then left, each counted as the largest. So no mixture of jobs takes more
// memory than there is.
#include <algorithm>
#include <string_view>

#include "common/base/error.h"
#include "preprocess/batch/engine_files.h"
#include "preprocess/batch/quoting.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

struct Pools {
  std::uint64_t most_of_light = 0;  ///< bytes: jobs that declare no more are light
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
  pools.most_of_light = all_fit ? all.memory : options.memory_bytes / 2 / options.cores;
  for (const Job& job : jobs) (job.memory_bytes <= pools.most_of_light ? light : heavy).add(job);
  pools.light_depth = at_least_one(options.cores / light.threads);
  if (heavy.memory == 0) return pools;
  const std::uint64_t left = options.memory_bytes - light.memory * pools.light_depth;
  pools.heavy_depth =
      at_least_one(std::min<std::uint64_t>(left / heavy.memory, options.cores / heavy.threads));
  return pools;
}

std::string paths(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text.append(" ").append(ninja_path(name));
  return text;
}

/// Files that other jobs make come first among the inputs, so that ninja runs those before.
std::string build_text(const Job& job, std::span<const Job> jobs, const EngineOptions& options,
                       const Pools& pools) {
  std::string text = "build" + paths(job.outputs) + (job.outputs.empty() ? " " : " | ") +
                     ninja_path(job.record) + ": " + kind_name(job.kind) + paths(job.inputs) +
                     " | $mdprep\n";
  text += "  line = " + ninja_value(shell_line(job_words(job, jobs, options, JobMessages::kNone))) +
          "\n";
  text += "  record = " + ninja_value(job.record) + "\n";
  return text + "  pool = " + (job.memory_bytes <= pools.most_of_light ? "light" : "heavy") + "\n";
}

std::string phony_text(std::string_view name, std::span<const Job> jobs, JobKind kind) {
  std::string text = "build " + std::string(name) + ": phony";
  for (const Job& job : jobs)
    if (job.kind == kind) text.append(" ").append(ninja_path(job.record));
  return text + "\n";
}

}  // namespace

std::string ninja_text(std::span<const Job> jobs, const EngineOptions& options) {
  const Pools pools = choose_pools(jobs, options);
  std::string text = "# From " + options.manifest +
                     " by mdprep batch. Run ninja in the manifest's folder.\n"
                     "ninja_required_version = 1.7\n"
                     "builddir = " +
                     ninja_value(options.records) + "\nmdprep = " + ninja_value(options.program) +
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

}  // namespace mdk
