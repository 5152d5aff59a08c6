// The body of BEN in shirt, shorts and shoes, as one distance field.
#pragma once

#include "assets/ben_rig.h"
#include "assets/sample_sequence.h"

namespace mdk {

class BenShape {
 public:
  explicit BenShape(const BenRig& rig) : rig_(rig) {}

  double distance(const Vec3d& p) const;
  double seam(const Vec3d& p) const;
  double edge_length(const Vec3d& p) const;  ///< before triangles are split once more
  ByteColor color(const Vec3d& p) const;
  Aabbd bounds() const { return {{-0.30, -0.03, -0.80}, {0.32, 1.88, 0.80}}; }

 private:
  double torso(const Vec3d& p) const;
  double head(const Vec3d& p) const;
  double hair(const Vec3d& p) const;
  double arm(const Vec3d& p, const BenLimbs& limbs) const;
  double hand(const Vec3d& p, const BenLimbs& limbs) const;
  double leg(const Vec3d& p, const BenLimbs& limbs) const;
  double shoe(const Vec3d& p, const BenLimbs& limbs) const;
  double shirt(const Vec3d& p) const;
  double shorts(const Vec3d& p) const;
  const BenLimbs& limbs_near(const Vec3d& p) const { return rig_.sides[p.z < 0]; }

  BenRig rig_;
};

}  // namespace mdk
