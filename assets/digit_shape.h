// The shape of one finger or thumb, as a distance field around its bones.
#pragma once

#include <array>

#include "assets/hand_skeleton.h"

namespace mdk {

/// Sizes in centimetres across a digit.
struct DigitProfile {
  std::array<double, 4> radii;  ///< at its three joints and near its tip
  double nail_width;            ///< half of it
  double nail_length;
};

class DigitShape {
 public:
  DigitShape(const HandSkeleton& skeleton, int digit);

  /// Signed distance to the digit's skin and nail.
  double distance(const Vec3d& p) const;

  /// Is this point of the surface on the nail?
  bool on_nail(const Vec3d& p) const;
  /// Signed distance to the nail's outline seen from its back; large in front of the bone.
  double nail_outline(const Vec3d& p) const;
  /// 0 at the nail's root, 1 at its free edge, for points on the nail.
  double along_nail(const Vec3d& p) const;

  /// Where the nail sits, for sampling it finely.
  const Vec3d& nail_center() const { return nail_center_; }
  /// A point `along` (0 to 1) the bone of phalanx `i`.
  Vec3d on_bone(std::size_t i, double along) const;
  const Basis& basis(std::size_t i) const { return bones_[i]; }
  double bone_length(std::size_t i) const { return lengths_[i]; }
  double radius(std::size_t i) const { return profile_.radii[i]; }

 private:
  double phalanx(std::size_t i, const Vec3d& p) const;
  double knuckle(std::size_t i, const Vec3d& p) const;
  double tip(const Vec3d& p) const;
  double nail_plate(const Vec3d& q) const;
  double outline(const Vec3d& q) const;

  std::array<Basis, kPhalanges> bones_;
  std::array<double, kPhalanges> lengths_{};
  DigitProfile profile_;
  Vec3d nail_center_;
  Vec3d bound_center_;
  double bound_radius_ = 0;
};

}  // namespace mdk
