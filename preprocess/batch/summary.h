// What came of a batch: every job's record, merged.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "preprocess/batch/job_record.h"
#include "preprocess/batch/plan.h"

namespace mdk {

/// A job and its record, if there is one that can be read.
struct JobOutcome {
  const Job* job = nullptr;
  std::optional<JobRecord> record;

  bool is_done() const { return record && record->status == JobStatus::kDone; }
  /// "done", "failed", …, or "missing" without a record.
  std::string status() const;
  /// Why it is not done, in a sentence; empty where it is.
  std::string reason() const;
  std::uint64_t output_bytes() const;
};

struct BatchTotals {
  std::size_t jobs = 0, done = 0;
  std::uint64_t output_bytes = 0;
  std::uint64_t peak_memory_bytes = 0;  ///< of the largest job
  double seconds = 0;                   ///< of all jobs that are done, one after another
};

/// All jobs, in the batch's order.
struct BatchSummary {
  std::vector<JobOutcome> outcomes;
  BatchTotals totals;

  /// Numbers of those that are not done.
  std::vector<std::size_t> failed() const;
  /// Numbers of the `count` that took longest, or most memory, or made the largest files.
  std::vector<std::size_t> slowest(std::size_t count) const;
  std::vector<std::size_t> hungriest(std::size_t count) const;
  std::vector<std::size_t> largest(std::size_t count) const;
};

/// Reads the jobs' records below `folder`. The jobs must outlive the summary.
BatchSummary summarize(std::span<const Job> jobs, const std::string& folder);

void print_summary(const BatchSummary& summary, std::ostream& out);

/// Schema "mdprep-batch/1".
std::string summary_json(const BatchSummary& summary);

/// One page that needs nothing else: no script, no other file.
std::string summary_html(const BatchSummary& summary, const std::string& title);

}  // namespace mdk
