// Refinement of a cluster's maps towards the smallest fuzzy boxes (GFW06 §4.1 notes that surface
// area is the better measure, and minimises squared distances all the same).
//
// The cost of a cluster is 2 sum over sides of W S: S sums the products of the boxes' extents, W is
// the mean over keys of what a local side is worth in the world (cost.h). Both are functions of the
// maps alone. Extents are ranges over time, which are not smooth; they are replaced by a 16-norm
// about the boxes' middles,
//
//     max over t of |x(t) - c|   <=   (sum over t of (x(t) - c)^16)^(1/16),
//
// which weighs the extreme keys and forgets the others. L-BFGS (Ceres) descends in the coordinates
// in which every key's points have unit scatter, where all entries of a map count alike. It needs
// sums and square roots alone, which are the same on every machine.
#pragma once

#include <span>
#include <vector>

#include "preprocess/maps/cluster_points.h"

namespace mdk {

/// `maps`: R, from centred row coordinates into the local basis; `model_areas`: R. Returns maps
/// that lower the smooth cost; the caller must ask the true one. Cost: O(rows * vertices) an
/// iteration.
std::vector<Affine3d> refine_maps(const ClusterPoints& points, std::span<const Affine3d> maps,
                                  std::span<const double> model_areas);

}  // namespace mdk
