// Two results side by side: did a change make anything faster or slower?
//
// Frames are compared key by key, so that the animation's own ups and downs cancel: the ratio is
// the median over keys of new / old, and its spread the quartiles of those ratios, widened by the
// spread of the rounds of the two measurements (TechniqueBench::round_spread). Where 1 lies within
// the spread, nothing can be said, and the two are called the same.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "preprocess/bench/results.h"

namespace mdk {

enum class Verdict { kFaster, kSame, kSlower };

struct ComparedTechnique {
  std::string setting;  ///< "avx2, 2 threads, 512x512, diffuse"
  std::string model, id;
  double old_ms = 0, new_ms = 0;  ///< median time to image
  Quartiles ratio;                ///< new / old; low and high are the spread
  Verdict verdict = Verdict::kSame;
  double visits_ratio = 1, tests_ratio = 1;  ///< of the counts: exactly 1 where nothing changed
};

/// Everything that both have measured at the same setting: model by name, technique by id, frame by
/// key. Throws Error (kBadInput) where there is nothing.
std::vector<ComparedTechnique> compare_results(const BenchResults& before,
                                               const BenchResults& after);

/// A table for each setting, a row for each technique, and a last line that counts the verdicts.
void print_comparison(std::ostream& out, const std::vector<ComparedTechnique>& rows);

}  // namespace mdk
