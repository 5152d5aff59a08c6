#include "preprocess/batch/job_record.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "formats/files/mapped_file.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "mdprep-job/1";
constexpr std::array<std::string_view, 5> kStatusNames = {"started", "done", "failed", "blocked",
                                                          "stopped"};

Json json_of(const std::vector<FileState>& states) {
  Json list = Json::array();
  for (const FileState& state : states)
    list.push_back({{"path", state.path}, {"bytes", state.bytes}, {"hash", hash_text(state.hash)}});
  return list;
}

std::uint64_t hash_of(const Json& value) {
  const std::string& text = value.get_ref<const std::string&>();
  std::uint64_t hash = 0;
  std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  return hash;
}

std::vector<FileState> states_of(const Json& list) {
  std::vector<FileState> states;
  for (const Json& entry : list)
    states.push_back({entry.at("path"), entry.at("bytes"), hash_of(entry.at("hash"))});
  return states;
}

JobStatus status_of(const std::string& name) {
  for (std::size_t i = 0; i < kStatusNames.size(); ++i)
    if (kStatusNames[i] == name) return static_cast<JobStatus>(i);
  throw std::invalid_argument(name);
}

JobRecord record_of(const Json& json) {
  if (json.at("schema") != kSchema) throw std::invalid_argument("another schema");
  JobRecord record;
  record.status = status_of(json.at("status"));
  record.command = json.at("command");
  record.version = json.at("version");
  record.program_hash = hash_of(json.at("program_hash"));
  record.command_hash = hash_of(json.at("command_hash"));
  record.host = json.at("host");
  record.process = json.at("process");
  record.task = json.at("task");
  record.exit_status = json.at("exit_status");
  record.reason = json.at("reason");
  record.seconds = json.at("seconds");
  record.peak_memory_bytes = json.at("peak_memory_bytes");
  record.inputs = states_of(json.at("inputs"));
  record.outputs = states_of(json.at("outputs"));
  record.unread = json.at("unread");
  if (!json.at("report").is_null()) record.report = json.at("report").dump();
  return record;
}

bool is_unchanged(const FileState& state) {
  std::error_code problem;
  if (std::filesystem::file_size(state.path, problem) != state.bytes || problem) return false;
  try {
    return state_of_file(state.path) == state;
  } catch (const Error&) {
    return false;  // whoever needs the file will say what is wrong with it
  }
}

}  // namespace

std::string_view status_name(JobStatus status) {
  return kStatusNames[static_cast<std::size_t>(status)];
}

std::string job_record_json(const JobRecord& record) {
  const Json json = {
      {"schema", kSchema},
      {"status", status_name(record.status)},
      {"command", record.command},
      {"version", record.version},
      {"program_hash", hash_text(record.program_hash)},
      {"command_hash", hash_text(record.command_hash)},
      {"host", record.host},
      {"process", record.process},
      {"task", record.task},
      {"exit_status", record.exit_status},
      {"reason", record.reason},
      {"seconds", record.seconds},
      {"peak_memory_bytes", record.peak_memory_bytes},
      {"inputs", json_of(record.inputs)},
      {"outputs", json_of(record.outputs)},
      {"unread", record.unread},
      {"report", record.report.empty() ? Json() : Json::parse(record.report)},
  };
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<JobRecord> read_job_record(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  try {
    return record_of(Json::parse(text));
  } catch (const std::exception&) {
    return std::nullopt;  // nothing but "do it again" follows from it
  }
}

FileState state_of_file(const std::string& path) {
  const MappedFile file(path);
  return {path, file.bytes().size(), checksum_of(file.bytes())};
}

std::vector<FileState> states_of_files(const std::vector<std::string>& paths) {
  std::vector<FileState> states;
  for (const std::string& path : paths) states.push_back(state_of_file(path));
  return states;
}

bool are_unchanged(const std::vector<FileState>& states) {
  return std::all_of(states.begin(), states.end(), is_unchanged);
}

bool is_readable(const std::string& path) {
  std::error_code problem;
  return std::filesystem::is_regular_file(path, problem) && std::ifstream(path).is_open();
}

}  // namespace mdk
