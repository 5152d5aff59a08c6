// Measures techniques on one model.
//
//     pass 0   every key: brute force, then each technique with counting on.
//              Gives counts, mismatches and all work that is done ahead of time.
//     rounds   each technique in turn plays the keys from first to last, as a viewer would, after
//              one untimed frame. Turns last a fraction of a second and every round starts with
//              another technique, so a burst of load on the machine hits all of them.
//
// A frame counts as the fastest of its rounds, with all phases from that round: what disturbs a
// machine only ever adds time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/progress.h"
#include "common/motion/model.h"
#include "common/trace/camera.h"
#include "common/trace/frame_stats.h"
#include "common/trace/shading.h"

namespace mdk {

struct BenchConfig {
  std::vector<std::string> techniques;  ///< ids from the table, each once
  std::vector<std::uint32_t> keys;      ///< rising, at least one
  Camera camera;
  std::uint32_t width = 512, height = 512;
  ShadingMode shading = ShadingMode::kDiffuse;
  std::uint32_t rounds = 3;  ///< at least one
};

struct BenchFrame {
  std::uint32_t key = 0;
  FrameStats stats;
};

struct TechniqueBench {
  std::string id;
  std::vector<BenchFrame> frames;
  TraceCounters counters;  ///< over all frames, from pass 0
  std::uint64_t rays = 0;  ///< over all frames
  std::uint64_t structure_bytes = 0;
  double prebuild_ms = 0;            ///< all work ahead of time for these keys
  std::uint64_t hit_mismatches = 0;  ///< by what the technique promises (TechniqueInfo)
  std::string note;                  ///< of the technique after its last frame, or empty

  /// Medians over the frames, phase by phase; time to image has a median of its own.
  FrameStats median_phases() const;
  double median_time_to_image_ms() const;
};

/// Takes over another round's figures where their time to image is shorter.
void keep_faster(BenchFrame& frame, const FrameStats& another);

/// In the order of `config.techniques`. Throws Error (kUsage) for a size or camera that cannot be.
std::vector<TechniqueBench> bench_techniques(const Model& model, const BenchConfig& config,
                                             ProgressSink& progress);

}  // namespace mdk
