// Where a bench's results go.
#pragma once

#include <string>
#include <vector>

#include "preprocess/cli/bench/results.h"

namespace mdk {

struct BenchOutputs {
  std::string json, csv, html, markdown;  ///< files; empty: not asked for
  std::vector<std::string> quoting;       ///< documents whose marked texts are made anew
};

/// Refuses what cannot be written, before any time is spent. `inputs`: files that are read and must
/// not be written over. Throws Error (kUsage, kIo).
void check_outputs(const BenchOutputs& outputs, const std::vector<std::string>& inputs);

/// All texts are made before the first file is written. Throws Error (kIo, kBadInput).
void write_outputs(const BenchOutputs& outputs, const BenchResults& results);

}  // namespace mdk
