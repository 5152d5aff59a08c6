// The two ways to clusters of triangles that move alike: by the cost of tracing their boxes, and as
// in GFW06, by residual motion.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/progress.h"
#include "common/math/affine3.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/pipeline.h"
#include "preprocess/pose_table.h"

namespace mdk {

struct MotionClusters {
  std::uint32_t rest_key = 0;
  std::vector<std::uint32_t> cluster_of_triangle;
  std::uint32_t cluster_count = 1;
  std::string stop_reason = "none";
  std::vector<ClusteringStep> steps;      ///< residuals in units of `unit`
  std::vector<Affine3d> local_from_rest;  ///< K, by residual motion alone: the local bases
};

/// A table of up to `count` keys, farthest-point sampled, and of `also`.
PoseTable sampled_table(const PoseSequence& sequence, std::size_t count,
                        std::optional<std::uint32_t> also, double unit);

/// Grown on a farthest-point sample of the keys, and of the triangles of large meshes; relaxed on
/// all triangles and as many keys as a work budget allows. `unit`: see pose_unit.
MotionClusters cluster_by_boxes(const PoseSequence& sequence, const DecomposeOptions& options,
                                double unit, ProgressSink& progress);

/// The paper's Algorithm 1 with its rest-pose rule (3) and principal axes as local bases.
MotionClusters cluster_by_residuals(const PoseSequence& sequence, const DecomposeOptions& options,
                                    double unit, ProgressSink& progress);

}  // namespace mdk
