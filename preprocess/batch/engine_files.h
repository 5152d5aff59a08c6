// What engines read: jobs as text for ninja, make, Slurm, and whatever runs lines of shell; and
// words and paths as these want them written. All run in the manifest's folder; each job is an
// 'mdprep job' line, so the engines agree on every byte.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "preprocess/batch/plan.h"

namespace mdk {

struct EngineOptions {
  std::string program = "mdprep";  ///< how jobs call mdprep
  std::string manifest;            ///< its name in its folder
  std::string folder;              ///< the manifest's, absolute: only Slurm's script has it
  std::string records;             ///< folder of records, relative to the manifest's
  std::uint32_t cores = 1;         ///< of the machine ninja runs on
  std::uint64_t memory_bytes = 0;  ///< of that machine
};

/// What a job is to tell while it runs.
enum class JobMessages { kNone, kPlainProgress };

/// "mdprep job --record=… -- bake … --threads=1 --memory-limit=2048M", word by word. `jobs` are all
/// of the batch.
std::vector<std::string> job_words(const Job& job, std::span<const Job> jobs,
                                   const EngineOptions& options, JobMessages messages);

/// One job a line, as a shell takes it, of the kinds that are asked for.
std::string job_list_text(std::span<const Job> jobs, std::span<const JobKind> kinds,
                          const EngineOptions& options);

/// A build.ninja: outputs, depfiles, restat, and two pools that keep the jobs that run at one time
/// within cores and memory. Targets: bakes, verifies, renders, and all of them by default. Throws
/// Error (kOverLimit) for a job that declares more memory than there is.
std::string ninja_text(std::span<const Job> jobs, const EngineOptions& options);

/// A Makefile for GNU make with the same depfiles and targets. Throws Error (kUsage) for names that
/// make cannot hold.
std::string make_text(std::span<const Job> jobs, const EngineOptions& options);

/// A shell script that submits arrays of jobs, those with the same needs together, and a summary
/// after all of them. With --wait it returns when that is there, with its exit status.
std::string slurm_text(std::span<const Job> jobs, const EngineOptions& options);

/// As it is where that is safe, else in single quotes.
std::string shell_word(const std::string& word);

/// Words with blanks between.
std::string shell_line(std::span<const std::string> words);

/// A path in a build statement of ninja.
std::string ninja_path(const std::string& path);

/// A value in ninja, or a recipe line of make.
std::string dollars_doubled(const std::string& text);

/// A target or prerequisite of make. Throws Error (kUsage) where make has no way to write it.
std::string make_path(const std::string& path);

}  // namespace mdk
