// A job's identity is its command line without what no result depends on (threads, instruction set,
// memory, messages). It is up to date when identity, program and the content of all files are what
// the record says.
#include "preprocess/batch/job_run.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <set>
#include <span>

#include "common/base/error.h"
#include "common/base/stopwatch.h"
#include "formats/files/atomic_file.h"
#include "formats/files/mapped_file.h"
#include "preprocess/batch/job_record.h"
#include "preprocess/tool/files.h"
#include "preprocess/tool/memory_limit.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

std::uint64_t hash_of_text(const std::string& text) {
  return checksum_of(std::as_bytes(std::span(text)));
}

std::string host_name() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

/// "4711_12" for task 12 of Slurm's array 4711.
std::string task_name() {
  const char* array = std::getenv("SLURM_ARRAY_JOB_ID");
  const char* task = std::getenv("SLURM_ARRAY_TASK_ID");
  return array != nullptr && task != nullptr ? std::string(array) + "_" + task : "";
}

JobRecord new_record(const JobRequest& request, const JobCommand& command) {
  JobRecord record;
  record.command = request.command;
  record.version = version_text(tool_version());
  record.program_hash = state_of_file("/proc/self/exe").hash;
  record.command_hash = hash_of_text(command.name + "\n" + command.options_text);
  record.host = host_name();
  record.process = getpid();
  record.task = task_name();
  return record;
}

/// A folder or a numbered sequence may have got frames that were not there when it was read.
bool read_all_sources(const JobCommand& command, const JobRecord& last) {
  if (!command.find_sources) return true;
  std::set<std::string> read;
  for (const FileState& input : last.inputs) read.insert(input.path);
  try {
    const std::vector<std::string> files = command.find_sources();
    return std::all_of(files.begin(), files.end(),
                       [&](const std::string& file) { return read.contains(file); });
  } catch (const Error&) {
    return false;  // the bake will say what is wrong
  }
}

bool is_up_to_date(const JobCommand& command, const JobRecord& last, const JobRecord& now) {
  return last.status == JobStatus::kDone && last.command_hash == now.command_hash &&
         last.program_hash == now.program_hash && last.version == now.version &&
         read_all_sources(command, last) && are_unchanged(last.inputs) &&
         are_unchanged(last.outputs) &&
         std::none_of(last.unread.begin(), last.unread.end(), is_readable);
}

std::set<std::string> output_folders(const JobRequest& request, const JobCommand& command) {
  std::set<std::string> folders;
  for (const std::string& file : {request.record, request.depfile, command.output})
    folders.insert(fs::path(file).parent_path().string());
  folders.erase("");
  return folders;
}

void make_folders(const std::set<std::string>& folders) {
  for (const std::string& folder : folders) {
    std::error_code problem;
    fs::create_directories(folder, problem);
    if (problem) throw io_error(folder, "cannot be made: " + problem.message());
  }
}

void require_needed(const std::vector<std::string>& needs) {
  for (const std::string& path : needs) {
    const auto needed = read_job_record(path);
    if (needed && needed->status == JobStatus::kDone) continue;
    const std::string what = needed ? std::string(status_name(needed->status)) : "not there";
    throw bad_input(path, "the job this one needs is " + what + "; see to that one first");
  }
}

/// Whose time stamp changes where `path` appears.
std::string existing_folder_of(const std::string& path) {
  fs::path folder = fs::path(path).parent_path();
  std::error_code problem;
  while (!folder.empty() && !fs::is_directory(folder, problem)) folder = folder.parent_path();
  return folder.empty() ? "." : folder.string();
}

void write_depfile(const JobRequest& request, const JobRecord& record) {
  if (request.depfile.empty()) return;
  std::vector<std::string> names;
  for (const FileState& input : record.inputs) names.push_back(input.path);
  for (const std::string& path : record.unread) names.push_back(existing_folder_of(path));
  write_text_file(request.depfile,
                  with_name("--depfile", [&] { return depfile_text(request.record, names); }));
}

/// Runs the command and fills in the rest of the record, whatever comes.
void run_command(const JobCommand& command, Interrupts& interrupts, JobRecord& record) {
  const Stopwatch watch;
  CommandContext context{interrupts, Overwrite::kIfChanged};
  command.run(context);
  record.seconds = watch.seconds();
  record.inputs = states_of_files(context.inputs);
  record.outputs = states_of_files(context.outputs);
  record.unread = context.unread;
  record.report = context.report;
  record.status = JobStatus::kDone;
}

JobStatus status_of_failure(const std::exception_ptr& thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Interrupted&) {
    return JobStatus::kStopped;
  } catch (...) {
    return JobStatus::kFailed;
  }
}

/// What `work` throws goes into the record before it goes on.
template <class Work>
void run_recorded(const std::string& path, JobRecord& record, Work work) {
  const Stopwatch watch;
  try {
    work();
  } catch (...) {
    const Failure failure = describe_failure(std::current_exception());
    if (record.status == JobStatus::kStarted)
      record.status = status_of_failure(std::current_exception());
    record.exit_status = failure.status;
    record.reason = failure.sentence;
    record.seconds = watch.seconds();
    record.peak_memory_bytes = peak_memory_bytes();
    write_text_file(path, job_record_json(record));
    throw;
  }
}

}  // namespace

JobResult run_job(const JobRequest& request, const JobCommand& command, Interrupts& interrupts) {
  if (command.name != "bake" && command.name != "verify" && command.name != "render")
    throw Error(ErrorCode::kUsage,
                "mdprep job: " + command.name + " is no job; give a bake, a verify or a render");
  const std::set<std::string> folders = output_folders(request, command);
  make_folders(folders);
  JobRecord record = new_record(request, command);
  run_recorded(request.record, record, [&] {
    record.status = JobStatus::kBlocked;
    require_needed(request.needs);
    record.status = JobStatus::kStarted;
  });

  const auto last = read_job_record(request.record);
  if (last && is_up_to_date(command, *last, record)) {
    write_depfile(request, *last);
    std::error_code ignored;  // for make, which asks for a newer time stamp than the inputs'
    fs::last_write_time(request.record, fs::file_time_type::clock::now(), ignored);
    return JobResult::kUpToDate;
  }
  if (last && last->status == JobStatus::kStarted)
    for (const std::string& folder : folders) remove_abandoned_temporaries(folder);

  write_text_file(request.record, job_record_json(record));
  run_recorded(request.record, record, [&] { run_command(command, interrupts, record); });
  record.peak_memory_bytes = peak_memory_bytes();
  write_depfile(request, record);
  write_text_file(request.record, job_record_json(record));
  return JobResult::kRan;
}

}  // namespace mdk
