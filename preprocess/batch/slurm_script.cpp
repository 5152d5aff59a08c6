// An array has one set of limits, so jobs with the same ones make an array. Renders wait for the
// end of the bakes' arrays, whatever came of single bakes; a render whose own bake failed says so
// and does not run.
#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "preprocess/batch/engine_files.h"

namespace mdk {
namespace {

constexpr std::size_t kMaxTasks = 1000;  // Slurm's own limit is 1001 where nobody raised it

/// Jobs of one array, by their numbers.
using JobArray = std::vector<std::size_t>;

std::vector<JobArray> make_arrays(std::span<const Job> jobs) {
  using Limits = std::tuple<JobKind, std::uint32_t, std::uint64_t, std::uint32_t>;
  std::map<Limits, JobArray> alike;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    alike[{jobs[i].kind, jobs[i].threads, jobs[i].memory_bytes, jobs[i].minutes}].push_back(i);
  std::vector<JobArray> arrays;
  for (const auto& [limits, numbers] : alike) {
    for (std::size_t first = 0; first < numbers.size(); first += kMaxTasks) {
      const std::size_t end = std::min(numbers.size(), first + kMaxTasks);
      arrays.emplace_back(numbers.begin() + static_cast<std::ptrdiff_t>(first),
                          numbers.begin() + static_cast<std::ptrdiff_t>(end));
    }
  }
  return arrays;
}

std::string array_name(std::size_t array) { return "array" + std::to_string(array); }

std::string dependency_text(const JobArray& array, std::span<const Job> jobs,
                            const std::map<std::size_t, std::size_t>& array_of_job) {
  std::set<std::size_t> needed;
  for (const std::size_t number : array)
    for (const std::size_t before : jobs[number].needs) needed.insert(array_of_job.at(before));
  std::string text;
  for (const std::size_t before : needed) text.append(":$").append(array_name(before));
  return text.empty() ? "" : " --dependency=afterany" + text;
}

/// Options of sbatch that all of its calls here have.
std::string common_text(const EngineOptions& options, const std::string& log) {
  return " --requeue --open-mode=append --output=" + shell_word(options.records + "/slurm/" + log) +
         " \"$@\"";
}

std::string limits_text(const Job& job) {
  constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
  const std::uint64_t mebibytes = (job.memory_bytes + kMebibyte - 1) / kMebibyte;
  return " --cpus-per-task=" + std::to_string(job.threads) + " --mem=" + std::to_string(mebibytes) +
         "M" + (job.minutes > 0 ? " --time=" + std::to_string(job.minutes) : "");
}

}  // namespace

std::string slurm_text(std::span<const Job> jobs, const EngineOptions& options) {
  const std::vector<JobArray> arrays = make_arrays(jobs);
  std::map<std::size_t, std::size_t> array_of_job;
  std::string text =
      "#!/bin/bash\n"
      "# From " +
      options.manifest + " by mdprep batch: " + std::to_string(jobs.size()) + " jobs in " +
      std::to_string(arrays.size()) +
      " arrays, and a summary after them.\n"
      "# usage: bash THIS [--wait] [SBATCH-OPTION...]\n"
      "set -euo pipefail\n"
      "cd " +
      shell_word(options.folder) +
      "\n"
      "wait=()\n"
      "if [[ ${1-} == --wait ]]; then wait=(--wait); shift; fi\n"
      "mkdir -p " +
      shell_word(options.records + "/slurm") + "\n\n";
  std::string all;
  for (std::size_t a = 0; a < arrays.size(); ++a) {
    const JobArray& array = arrays[a];
    const Job& first = jobs[array.front()];
    text += array_name(a) + "=$(sbatch --parsable --job-name=mdprep-" + kind_name(first.kind) +
            " --array=0-" + std::to_string(array.size() - 1) + limits_text(first) +
            dependency_text(array, jobs, array_of_job) + common_text(options, "%x-%A_%a.log") +
            " <<'TASKS'\n#!/bin/bash\ncase $SLURM_ARRAY_TASK_ID in\n";
    for (std::size_t task = 0; task < array.size(); ++task) {
      text += std::to_string(task) + ") exec " +
              shell_line(job_words(jobs[array[task]], jobs, options, JobMessages::kPlainProgress)) +
              " ;;\n";
      array_of_job[array[task]] = a;
    }
    const std::string name = array_name(a);
    text.append("esac\nTASKS\n)\n").append(name).append("=${").append(name).append("%%;*}\n\n");
    all.append(":$").append(array_name(a));
  }
  const std::string log = shell_word(options.records + "/slurm/summary.log");
  const std::vector<std::string> summary = {options.program,
                                            "batch",
                                            options.manifest,
                                            "--summary",
                                            "--html=" + options.records + "/summary.html",
                                            "--json=" + options.records + "/summary.json"};
  text += "rm -f " + log +
          "\nstatus=0\nsbatch \"${wait[@]}\" --job-name=mdprep-summary --mem=512M"
          " --dependency=afterany" +
          all + common_text(options, "summary.log") +
          " <<'TASKS' || status=$?\n#!/bin/bash\nexec " + shell_line(summary) + "\nTASKS\n" +
          "if ((${#wait[@]})); then cat " + log + "; fi\nexit $status\n";
  return text;
}

}  // namespace mdk
