// The best affine map from one pose of a cluster to its rest pose, in closed form from weighted
// sums (GFW06 §3.2), and usable whatever the sums say.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "common/math/vec3.h"
#include "preprocess/decomposition.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {

/// Weighted sums over pairs (source point v, target point r), centred on their means.
struct FitMoments {
  double weight = 0;  ///< sum of w
  Vec3d source_mean, target_mean;
  double source[3][3] = {};  ///< sum of w (v - mean)(v - mean)^T
  double cross[3][3] = {};   ///< sum of w (r - mean)(v - mean)^T
  double target_trace = 0;   ///< sum of w |r - mean|^2
};

/// Adds up pairs. Sums are taken about the first pair, so that a small cluster far from the origin
/// loses no digits.
class MomentSum {
 public:
  void add(const Vec3d& source, const Vec3d& target, double weight);
  FitMoments moments() const;

 private:
  double weight_ = 0;
  Vec3d source_origin_, target_origin_;
  double source_[3] = {}, target_[3] = {};
  double source_square_[6] = {};  // xx yy zz xy yz zx
  double cross_[3][3] = {};       // target by source
  double target_square_ = 0;
};

struct FitOptions {
  double noise = 0;            ///< length below which differences of positions mean nothing
  double ridge = 0.05;         ///< pull towards a similarity, in units of the fit's own residual
  double max_condition = 1e3;  ///< largest ratio of singular values of the map
  double max_scale = 1e4;      ///< singular values lie in [1 / max_scale, max_scale]
  /// No mirroring: a nearly flat cluster, whose thin side is noise, would else be turned inside out
  /// at some keys, and collapse on the way there. Least squares alone does not ask for it.
  bool keep_orientation = false;
};

struct AffineFit {
  Affine3d target_from_source;
  double residual = 0;  ///< sum of w |map(v) - r|^2
};

/// Least squares with a ridge towards the best similarity (Kabsch 1976, Umeyama 1991; always a
/// proper rotation, the one nearest the identity where the points leave it open). The ridge is as
/// strong as the points are noisy: it is nothing where an affine map explains them, and decides
/// alone in directions in which they have no extent. So flat, thin and collapsed clusters get a map
/// that is invertible with the condition number of the options.
AffineFit fit_affine(const FitMoments& moments, const FitOptions& options = {});

/// The directions in which points scatter, as the rows of a proper rotation, the least scatter
/// first. `scatter`: symmetric, sums of (p - mean)(p - mean)^T.
Affine3d principal_rotation(const double (&scatter)[3][3]);

/// The fit's options in table units, where float positions are good to 2^-24 or so.
inline constexpr FitOptions kTableFit{.noise = 1e-7};

/// Least-squares maps of K clusters from each of R rows to the rest row, both in table coordinates;
/// corners weigh alike. K * R, cluster-major. Cost: O(rows * vertices).
std::vector<Affine3d> fit_clusters(const PoseTable& table, const ClusterMembers& members,
                                   std::uint32_t rest_row);

/// The maps of one cluster of the triangles `chosen`: R.
std::vector<Affine3d> fit_triangles(const MovingMesh& mesh, std::span<const std::uint32_t> chosen,
                                    std::uint32_t rest_row);

/// For every cluster and vertex, the sum over rows of |map(v) - r|^2, in table units. `maps`: K *
/// R, cluster-major. Returns K * V, cluster-major. The dense kernel of clustering by residuals: O(K
/// * R * V), vectorised.
std::vector<float> vertex_residuals(const PoseTable& table, std::uint32_t rest_row,
                                    std::span<const Affine3d> maps);

}  // namespace mdk
