// The shape of the whole sample hand in its sleeve, as one distance field.
#pragma once

#include <vector>

#include "assets/digit_shape.h"
#include "assets/hand_skeleton.h"
#include "common/math/aabb.h"

namespace mdk {

/// What a point of the surface is made of.
enum class HandPart { kSkin, kNail, kBand, kSleeve };

class HandShape {
 public:
  explicit HandShape(const HandSkeleton& skeleton);

  /// Signed distance in centimetres, smooth over skin; the solid is closed at the arm's end.
  double distance(const Vec3d& p) const;
  /// The edge length at which triangles show the shape well: short at nails, long at the arm.
  double edge_length(const Vec3d& p) const;
  HandPart part(const Vec3d& p) const;
  /// On the surface, signed distance to the nearest line where colours meet.
  double seam(const Vec3d& p) const;
  Aabbd bounds() const;

  const std::vector<DigitShape>& digits() const { return digits_; }

 private:
  double palm(const Vec3d& p) const;
  double arm(const Vec3d& p) const;
  double muscles(double d, const Vec3d& p) const;
  double webs(double d, const Vec3d& p) const;
  double tendons(double d, const Vec3d& p) const;
  double sleeve(const Vec3d& p) const;

  std::vector<DigitShape> digits_;
};

}  // namespace mdk
