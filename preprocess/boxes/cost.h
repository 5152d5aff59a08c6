// Cost: the expected work of a ray that hits the model, the one measure behind every decision
// (docs/method.md, cost). Areas count in world space: a cluster's map does not keep their ratios,
// so local boxes are mapped back. A box becomes a parallelepiped, whose area is closed form:
//
//     edges X e_x, X e_y, X e_z with X = L^-1, L the linear part of local_from_world:
//     side spanned by x and y:  e_x e_y |row z of L| / |det L|,  and so on round.
//
// A nearly singular map makes tiny local boxes that are huge in the world; one such key in a
// thousand must not decide for all. So the mean over keys is winsorised: a weight above 8
// times the median over keys counts as that.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/structures/kd_tree.h"

namespace mdk {

/// What the clusters themselves cost a ray that hits the model, in units of a triangle box hit:
/// entering one, and one more that the top level looks at, entered or not. Fitted to the times of
/// single rays and of tiles through 50 bakes of 2 to 140 clusters (docs/method.md, cost).
inline constexpr double kEnteringCost = 6, kClusterCost = 0.12;

/// World area of a local box with extent e, as weights of its sides.
AreaWeights world_area_weights(const Affine3d& local_from_world);

/// Mean of `values`, outliers capped; 0 of none.
double winsorised_mean(std::span<const double> values);

/// Per-cluster weights averaged over keys, in units of the model's box area at each key: what the
/// fuzzy tree of the cluster is built with. `maps` and `model_areas`: one per key; keys at which
/// the model has no area are left out.
AreaWeights mean_area_weights(std::span<const Affine3d> maps, std::span<const double> model_areas);

/// Where outliers among those weights are capped; zeros where the model never has an area.
AreaWeights area_weight_caps(std::span<const Affine3d> maps, std::span<const double> model_areas);

/// Area weights of all clusters, averaged over any run of keys in O(1). Over all keys they are
/// those of mean_area_weights: a run's outliers are judged by the median over all keys, too, so
/// that short runs next to a singular map are not mistaken for expensive ones.
class AreaWeightTable {
 public:
  /// `local_from_world`: F * K, key-major. `model_areas`: F; keys without area are left out.
  AreaWeightTable(std::span<const Affine3f> local_from_world, std::span<const double> model_areas);
  /// Mean over first_key..last_key, both inclusive; plain areas where no such key has any.
  AreaWeights mean(std::size_t cluster, std::uint32_t first_key, std::uint32_t last_key) const;

 private:
  std::size_t keys_, clusters_;
  std::vector<AreaWeights> sums_;      ///< K * (F + 1): over the keys before
  std::vector<std::uint32_t> counts_;  ///< F + 1
};

/// Sums over boxes of the products of their extents, so that any weights give the summed area.
struct FaceSums {
  double xy = 0, yz = 0, zx = 0;

  template <class T>
  void add(const BasicAabb<T>& box) {
    if (box.empty()) return;
    const double ex = static_cast<double>(box.hi.x) - box.lo.x;
    const double ey = static_cast<double>(box.hi.y) - box.lo.y;
    const double ez = static_cast<double>(box.hi.z) - box.lo.z;
    xy += ex * ey;
    yz += ey * ez;
    zx += ez * ex;
  }
  FaceSums operator*(double f) const { return {xy * f, yz * f, zx * f}; }
  double area(const AreaWeights& w) const { return 2 * (w.xy * xy + w.yz * yz + w.zx * zx); }
};

/// Mean over keys of a cluster's share of the model's area in the world: how probable it is that a
/// ray that hits the model's box enters the cluster's. Keys at which the model has no area are left
/// out; 1 where it never has any.
template <class T>
double mean_hit_probability(std::span<const BasicAabb<T>> world_boxes,
                            std::span<const double> model_areas) {
  double entered = 0, counted = 0;
  for (std::size_t key = 0; key < world_boxes.size(); ++key) {
    if (!(model_areas[key] > 0)) continue;
    entered += surface_area(world_boxes[key]) / model_areas[key];
    counted += 1;
  }
  return counted > 0 ? entered / counted : 1;
}

/// One cluster as the cost sees it.
struct ClusterWork {
  FaceSums fuzzy_boxes;        ///< of its triangles, in its local basis
  AreaWeights weights;         ///< from mean_area_weights
  double hit_probability = 0;  ///< see mean_hit_probability

  double area() const { return fuzzy_boxes.area(weights); }
  /// What a ray pays for the cluster besides its boxes.
  double overhead() const { return hit_probability * kEnteringCost + kClusterCost; }
  double cost() const { return area() + overhead(); }
};

/// Sum over triangles of the fuzzy boxes' mean areas in units of the model's: the triangle boxes
/// that a ray that hits the model is expected to hit.
double fuzzy_area(std::span<const ClusterWork> clusters);

/// fuzzy_area plus the cost of the clusters entered.
double expected_work(std::span<const ClusterWork> clusters);

}  // namespace mdk
