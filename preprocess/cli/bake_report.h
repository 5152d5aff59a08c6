// What a bake came to: the JSON report for scripts and a few lines for people.
#pragma once

#include <cstdint>
#include <string>

#include "common/motion/model.h"
#include "preprocess/pipeline.h"

namespace mdk {

struct BakeSeconds {
  double read = 0, decompose = 0, build = 0, write = 0, total = 0;
};

struct BakeOutcome {
  std::string input, output;  ///< as given on the command line
  std::string read_through;   ///< what read the input in mdprep's place; empty: nothing
  BakeSeconds seconds;
  std::uint64_t peak_memory_bytes = 0;  ///< resident, with pages of mapped files
  std::uint64_t file_bytes = 0;
  std::uint64_t scratch_bytes = 0;  ///< lists that stood in files without a name
};

/// Schema "mdprep-bake/1".
std::string bake_report_json(const Model& model, const DecomposeStats& stats,
                             const BakeOutcome& outcome);

std::string bake_summary(const Model& model, const DecomposeStats& stats,
                         const BakeOutcome& outcome);

}  // namespace mdk
