// Bench results as a table, as JSON and as CSV.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>
#include <vector>

#include "preprocess/cli/bench_run.h"

namespace mdk {

struct ModelBench {
  std::string file;  ///< as given on the command line
  std::uint32_t triangles = 0, keys = 0, clusters = 0;
  std::vector<TechniqueBench> techniques;
};

struct BenchMachine {
  std::string isa;
  int threads = 0;
  std::uint32_t width = 0, height = 0;
};

/// One aligned table, a row per model and technique.
void print_bench_table(std::ostream& out, std::span<const ModelBench> models);

/// Schema "mdprep-bench/1".
std::string bench_json(const BenchMachine& machine, std::span<const ModelBench> models);

/// A header line, then a row per model and technique with the names of the JSON.
std::string bench_csv(const BenchMachine& machine, std::span<const ModelBench> models);

}  // namespace mdk
