#include "preprocess/batch/summary.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <ostream>

#include "preprocess/tool/text.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShown = 5;
constexpr std::size_t kInJson = 20;

BatchTotals totals_of(const std::vector<JobOutcome>& outcomes) {
  BatchTotals totals;
  totals.jobs = outcomes.size();
  for (const JobOutcome& outcome : outcomes) {
    if (!outcome.is_done()) continue;
    ++totals.done;
    totals.output_bytes += outcome.output_bytes();
    totals.seconds += outcome.record->seconds;
    totals.peak_memory_bytes =
        std::max(totals.peak_memory_bytes, outcome.record->peak_memory_bytes);
  }
  return totals;
}

/// Numbers of done jobs, those with the largest measure first, ties in the batch's order.
template <class Measure>
std::vector<std::size_t> top(const BatchSummary& summary, std::size_t count, Measure measure) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < summary.outcomes.size(); ++i)
    if (summary.outcomes[i].is_done()) numbers.push_back(i);
  std::stable_sort(numbers.begin(), numbers.end(), [&](std::size_t a, std::size_t b) {
    return measure(summary.outcomes[a]) > measure(summary.outcomes[b]);
  });
  numbers.resize(std::min(numbers.size(), count));
  return numbers;
}

std::vector<std::string> cells_of(const JobOutcome& outcome) {
  return {kind_name(outcome.job->kind), outcome.job->record,
          fixed_text(outcome.record->seconds, 2) + " s",
          bytes_text(outcome.record->peak_memory_bytes), bytes_text(outcome.output_bytes())};
}

void print_top(const BatchSummary& summary, const char* title,
               const std::vector<std::size_t>& numbers, std::ostream& out) {
  if (numbers.empty()) return;
  TextTable table(2);
  table.add_row({title, "record", "seconds", "memory", "files"});
  for (const std::size_t i : numbers) table.add_row(cells_of(summary.outcomes[i]));
  out << "\n";
  table.print(out);
}

Json json_of(const JobOutcome& outcome) {
  Json json = {{"kind", kind_name(outcome.job->kind)},
               {"record", outcome.job->record},
               {"place", outcome.job->place},
               {"status", outcome.status()}};
  if (!outcome.is_done()) json["reason"] = outcome.reason();
  if (!outcome.record) return json;
  json["exit_status"] = outcome.record->exit_status;
  json["host"] = outcome.record->host;
  json["task"] = outcome.record->task;
  json["seconds"] = outcome.record->seconds;
  json["peak_memory_bytes"] = outcome.record->peak_memory_bytes;
  json["output_bytes"] = outcome.output_bytes();
  return json;
}

Json json_of(const BatchSummary& summary, const std::vector<std::size_t>& numbers) {
  Json list = Json::array();
  for (const std::size_t i : numbers) list.push_back(json_of(summary.outcomes[i]));
  return list;
}

}  // namespace

std::string JobOutcome::status() const {
  return record ? std::string(status_name(record->status)) : "missing";
}

std::string JobOutcome::reason() const {
  if (!record) return "no record: it never ran, or its record is damaged";
  if (record->status == JobStatus::kStarted)
    return "it runs still, or was killed without a word (process " +
           std::to_string(record->process) + " on " + record->host + "); run it again";
  return record->reason;
}

std::uint64_t JobOutcome::output_bytes() const {
  if (!record) return 0;
  return std::accumulate(
      record->outputs.begin(), record->outputs.end(), std::uint64_t{0},
      [](std::uint64_t sum, const FileState& output) { return sum + output.bytes; });
}

std::vector<std::size_t> BatchSummary::failed() const {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0; i < outcomes.size(); ++i)
    if (!outcomes[i].is_done()) numbers.push_back(i);
  return numbers;
}

std::vector<std::size_t> BatchSummary::slowest(std::size_t count) const {
  return top(*this, count, [](const JobOutcome& o) { return o.record->seconds; });
}

std::vector<std::size_t> BatchSummary::hungriest(std::size_t count) const {
  return top(*this, count, [](const JobOutcome& o) { return o.record->peak_memory_bytes; });
}

std::vector<std::size_t> BatchSummary::largest(std::size_t count) const {
  return top(*this, count, [](const JobOutcome& o) { return o.output_bytes(); });
}

BatchSummary summarize(std::span<const Job> jobs, const std::string& folder) {
  BatchSummary summary;
  for (const Job& job : jobs)
    summary.outcomes.push_back(
        {&job, read_job_record((std::filesystem::path(folder) / job.record).string())});
  summary.totals = totals_of(summary.outcomes);
  return summary;
}

void print_summary(const BatchSummary& summary, std::ostream& out) {
  const BatchTotals& totals = summary.totals;
  out << totals.done << " of " << totals.jobs << " jobs done, " << bytes_text(totals.output_bytes)
      << " made in " << fixed_text(totals.seconds, 1) << " s of work, largest job "
      << bytes_text(totals.peak_memory_bytes) << " of memory\n";
  const std::vector<std::size_t> failed = summary.failed();
  if (!failed.empty()) {
    TextTable table(3);
    table.add_row({"not done", "record", "reason"});
    for (const std::size_t i : failed) {
      const JobOutcome& outcome = summary.outcomes[i];
      table.add_row({outcome.status(), outcome.job->record, outcome.reason()});
    }
    out << "\n";
    table.print(out);
  }
  print_top(summary, "slowest", summary.slowest(kShown), out);
  print_top(summary, "hungriest", summary.hungriest(kShown), out);
  print_top(summary, "largest", summary.largest(kShown), out);
}

std::string summary_json(const BatchSummary& summary) {
  const BatchTotals& totals = summary.totals;
  const Json json = {{"schema", "mdprep-batch/1"},
                     {"totals",
                      {{"jobs", totals.jobs},
                       {"done", totals.done},
                       {"not_done", totals.jobs - totals.done},
                       {"seconds", totals.seconds},
                       {"output_bytes", totals.output_bytes},
                       {"peak_memory_bytes", totals.peak_memory_bytes}}},
                     {"not_done", json_of(summary, summary.failed())},
                     {"slowest", json_of(summary, summary.slowest(kInJson))},
                     {"hungriest", json_of(summary, summary.hungriest(kInJson))},
                     {"largest", json_of(summary, summary.largest(kInJson))}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mdk
