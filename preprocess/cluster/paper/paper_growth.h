// Algorithm 1 of GFW06: start with one cluster, relax, add a cluster where motion is worst, and go
// on until another one gains too little.
#pragma once

#include <vector>

#include "common/base/progress.h"
#include "common/math/affine3.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"
#include "preprocess/options.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

/// Grows clusters on the rows of `mesh`, to `request.clusters` or until the next one would lower
/// the residual by less than `request.stop_percent`, at most to 64. After each insertion Lloyd runs
/// twice, from the clusters as they are and from prototypes (GFW06 restarts always; keeping wins
/// about as often), and the lower residual stays. The rest pose, where it is not requested, is the
/// one that GFW06 (3) prefers, searched again whenever the number of clusters has doubled.
/// `on_step` is called after each step. There must be as many triangles as clusters are requested.
Growth grow_by_residuals(const MovingMesh& mesh, const ClusterRequest& request,
                         const OnGrowthStep& on_step);

/// Clusters with the principal axes of their residual motion as local bases.
struct PaperClusters : Growth {
  std::vector<Affine3d> local_from_rest;  ///< K: see LocalFrames
};

/// Grown on a farthest-point sample of the keys, then relaxed on as many as a work budget allows.
/// `unit`: see pose_unit.
PaperClusters cluster_by_residuals(const PoseSequence& sequence, const ClusterRequest& request,
                                   double unit, ProgressSink& progress);

}  // namespace mdk
