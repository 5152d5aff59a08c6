// Bench results as lines of text: a table for people, CSV for spreadsheets.
#pragma once

#include <iosfwd>
#include <string>

#include "preprocess/cli/bench/results.h"

namespace mdk {

/// One aligned table for all models of a run, a row per technique, then the techniques' notes.
void print_bench_table(std::ostream& out, const BenchRun& run);

/// A header line, then a row per run, model and technique with the names of the JSON.
std::string results_csv(const BenchResults& results);

}  // namespace mdk
