// JobRecord: what is known of a job after it ran, or since it started: one small JSON file a job
// (mdprep-job/1, docs/farm.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mdk {

/// What a file held, so that a later run can tell whether it still does.
struct FileState {
  std::string path;
  std::uint64_t bytes = 0;
  std::uint64_t hash = 0;  ///< XXH3 of the content

  bool operator==(const FileState&) const = default;
};

enum class JobStatus {
  kStarted,  ///< and not ended: it runs, or it was killed
  kDone,
  kFailed,
  kBlocked,  ///< did not run, since a job it needs did not succeed
  kStopped,  ///< by SIGTERM or SIGINT
};

/// As in the file: "started", "done", "failed", "blocked", "stopped".
std::string_view status_name(JobStatus status);

struct JobRecord {
  JobStatus status = JobStatus::kStarted;
  std::vector<std::string> command;  ///< words after "mdprep"
  std::string version;               ///< of mdprep
  std::uint64_t program_hash = 0;    ///< XXH3 of the executable: another build, another result
  std::uint64_t command_hash = 0;  ///< of the command, its files and the options that shape results
  std::string host;
  std::int64_t process = 0;
  std::string task;  ///< the engine's own name for it, where it has one ("4711_12" in Slurm)
  int exit_status = 0;
  std::string reason;  ///< a sentence, where it did not succeed
  double seconds = 0;
  std::uint64_t peak_memory_bytes = 0;
  std::vector<FileState> inputs, outputs;  ///< of a job that is done
  std::vector<std::string> unread;         ///< inputs it went without: images that are not there
  std::string report;                      ///< the command's own JSON, or empty
};

std::string job_record_json(const JobRecord& record);

/// None where there is no file, or one that is no record: cut, or written by hand.
std::optional<JobRecord> read_job_record(const std::string& path);

/// Reads the whole file. Throws Error (kIo).
FileState state_of_file(const std::string& path);

std::vector<FileState> states_of_files(const std::vector<std::string>& paths);

/// Whether every file is there and holds what it held.
bool are_unchanged(const std::vector<FileState>& states);

/// Whether it is a file and opens.
bool is_readable(const std::string& path);

}  // namespace mdk
