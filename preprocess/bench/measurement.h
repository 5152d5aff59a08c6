// Measures techniques on one model.
//
//     pass 0   every key: each technique with counting on, and brute force where it judges.
//              Gives counts, mismatches and all work that is done ahead of time.
//     rounds   each technique in turn plays the keys from first to last, as a viewer would, after
//              one untimed frame. Turns last a fraction of a second and every round starts with
//              another technique, so a burst of load on the machine hits all of them.
//
// A frame counts as the fastest of its rounds, with all phases from that round: what disturbs a
// machine only ever adds time. Medians are over the frames; the rounds' own medians are kept, since
// how far the fastest two lie apart tells how far a difference can be trusted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "common/motion/model.h"
#include "common/trace/renderer.h"
#include "preprocess/bench/results.h"

namespace mdk {

struct BenchConfig {
  std::vector<std::string> techniques;  ///< ids from the table, each once
  std::uint32_t frames = 20;            ///< keys spread over the clips; no more than there are
  std::uint32_t rounds = 3;             ///< at least one
  std::uint32_t judged = 0xffffffffu;   ///< how many of the frames brute force judges
  FrameRequest request;                 ///< what a frame is, but for its key
};

/// In the order of `config.techniques`. Throws Error (kUsage) for a size or camera that cannot be.
std::vector<TechniqueBench> bench_techniques(const ModelView& model, const BenchConfig& config,
                                             ProgressSink& progress);

/// The processor's name as the system gives it, or "unknown processor"; cores this process may use.
BenchMachine this_machine();

BenchProgram this_program(const std::string& commit);

}  // namespace mdk
