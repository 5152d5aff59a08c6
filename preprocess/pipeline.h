// From a pose sequence to a model: Algorithm 1 of GFW06 and what surrounds it, top to bottom.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/progress.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"

namespace mdk {

enum class DecomposeMode {
  kMotion,  ///< clusters of triangles that move alike (GFW06 §3.1)
  kBones,   ///< a cluster for each bone of the rig (preprocess/bone_clusters.h)
  kNone,    ///< a cluster for each mesh, with identity maps: fuzzy boxes in world space
};

/// The poses that the boxes of bones hold for.
enum class PoseSampling {
  kCycle,      ///< those of the clips
  kPoseSpace,  ///< and each in which no joint is turned past its limit
};

struct DecomposeOptions {
  DecomposeMode mode = DecomposeMode::kMotion;
  PoseSampling sampling = PoseSampling::kCycle;  ///< with kBones only
  double joint_limit_degrees = 90;               ///< with kPoseSpace only; in [0, 180]
  std::uint32_t clusters = 0;                    ///< exactly so many; 0: as many as pay
  std::optional<double> stop_percent;  ///< GFW06's rule: stop when a cluster lowers the residual by
                                       ///< less than this; without it the cost decides
  std::optional<std::uint32_t> rest_key;  ///< fixed rest pose; none: searched
  std::uint32_t segments = 0;             ///< exactly so many, or as many as there can be; 0: as
                                          ///< many as pay
  bool refine = true;                     ///< improve maps towards the smallest boxes
  std::optional<double> quantize;  ///< key positions may be so far off, in rest pose diagonals, to
                                   ///< take less room; a rig that takes less still stays exact
};

/// What happened while clusters were added, stage by stage, on the keys that were looked at then.
struct ClusteringStep {
  std::uint32_t clusters = 0;
  double residual_rms = 0;  ///< about the boxes' middles (with stop_percent: the rest pose),
                            ///< relative to the rest pose's diagonal
  double sah_cost = 0;      ///< expected work per ray that meets the model (docs/method.md, cost)
  double fuzzy_area = 0;    ///< summed area of the fuzzy boxes, in areas of the model's box
};

struct DecomposeStats {
  std::uint32_t rest_key = 0;
  std::string stop_reason;  ///< one of: "cost", "percent", "count", "limit", "bones", "none"
  double residual_rms = 0;  ///< over all keys, relative to the rest pose's diagonal
  double residual_max = 0;
  std::optional<QuantizationError> quantization;  ///< where poses were quantised
  double sah_cost = 0;
  double refine_gain = 0;  ///< share by which refinement lowered the summed area of fuzzy boxes
  std::vector<ClusteringStep> steps;
  std::vector<std::string> notes;  ///< sentences on what could not be done as asked
  double decompose_seconds = 0, build_seconds = 0;
};

struct DecomposeResult {
  ModelStorage model;
  DecomposeStats stats;
};

/// Consumes the sequence (its positions move into the model). The result depends on the input and
/// options alone, not on the thread count or instruction set. Throws Error: kUsage (a rest key or
/// cluster count that does not exist), kBadInput (no triangles).
DecomposeResult decompose(PoseSequence sequence, const DecomposeOptions& options,
                          ProgressSink& progress);

}  // namespace mdk
