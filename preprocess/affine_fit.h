// The best affine map from one pose of a cluster to its rest pose, in closed form from weighted
// sums (GFW06 §3.2), and usable whatever the sums say.
#pragma once

#include "common/math/affine3.h"
#include "common/math/vec3.h"

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

}  // namespace mdk
