#include <algorithm>

#include "preprocess/batch/engine_files.h"
#include "preprocess/batch/quoting.h"

namespace mdk {
namespace {

/// "2048M" where it is whole.
std::string size_word(std::uint64_t bytes) {
  constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20;
  return bytes % kMebibyte == 0 ? std::to_string(bytes / kMebibyte) + "M" : std::to_string(bytes);
}

}  // namespace

std::vector<std::string> job_words(const Job& job, std::span<const Job> jobs,
                                   const EngineOptions& options, JobMessages messages) {
  std::vector<std::string> words = {options.program, "job", "--record=" + job.record,
                                    "--depfile=" + job.record + ".d"};
  for (const std::size_t needed : job.needs) words.push_back("--needs=" + jobs[needed].record);
  if (messages == JobMessages::kNone) words.emplace_back("-q");
  words.emplace_back("--");
  words.insert(words.end(), job.command.begin(), job.command.end());
  words.push_back("--threads=" + std::to_string(job.threads));
  words.push_back("--memory-limit=" + size_word(job.memory_bytes));
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

}  // namespace mdk
