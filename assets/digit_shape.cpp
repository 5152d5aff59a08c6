// A digit is three tapered capsules along its bones, a soft pad on the palm side of each, a bump on
// the back of each joint, and a thin curved plate for the nail:
//
//        back   ___o____o___ ~nail
//     palm ====(____)(___)(__)          o joint bumps, ( ) pads
//
#include "assets/digit_shape.h"

namespace mdk {
namespace {

constexpr std::array<DigitProfile, kDigits> kProfiles = {{
    {{1.20, 0.98, 0.90, 0.62}, 0.58, 1.26},
    {{0.98, 0.86, 0.74, 0.56}, 0.44, 1.04},
    {{1.00, 0.88, 0.76, 0.57}, 0.46, 1.10},
    {{0.96, 0.83, 0.72, 0.54}, 0.43, 1.02},
    {{0.84, 0.71, 0.62, 0.47}, 0.36, 0.84},
}};

// Fingers are a little wider than deep.
constexpr double kDepth = 0.93;

// How far beyond the bone the nail ends, in radii of the tip.
constexpr double kNailEnd = 0.55;

}  // namespace

DigitShape::DigitShape(const HandSkeleton& skeleton, int digit)
    : profile_(kProfiles[static_cast<std::size_t>(digit)]) {
  double reach = 0;
  for (std::size_t i = 0; i < kPhalanges; ++i) {
    const int joint = skeleton.digits[static_cast<std::size_t>(digit)][i];
    bones_[i] = skeleton.rest(joint);
    lengths_[i] = skeleton.bone_length(joint);
    reach += lengths_[i];
  }
  nail_center_ = bones_[2].to_world({0, lengths_[2] - 0.35 * profile_.nail_length, -radius(3)});
  bound_center_ = (bones_[0].origin + on_bone(2, 1)) * 0.5;
  bound_radius_ = reach * 0.5 + 1.3;
}

Vec3d DigitShape::on_bone(std::size_t i, double along) const {
  return bones_[i].to_world({0, lengths_[i] * along, 0});
}

double DigitShape::distance(const Vec3d& p) const {
  // Far away a bound will do: nothing blends over more than 2 cm.
  const double bound = length(p - bound_center_) - bound_radius_;
  if (bound > 2.0) return bound;
  double d = smooth_min(phalanx(0, p), phalanx(1, p), 0.25);
  d = smooth_min(d, tip(p), 0.22);
  d = smooth_min(d, knuckle(1, p), 0.5);
  return smooth_min(d, knuckle(2, p), 0.45);
}

double DigitShape::phalanx(std::size_t i, const Vec3d& p) const {
  const Vec3d q = bones_[i].to_local(p);
  const double len = lengths_[i], r0 = radius(i), r1 = radius(i + 1);
  const double bone = kDepth * rounded_cone({q.x, q.y, q.z / kDepth}, r0, r1, len);
  const double r = 0.5 * (r0 + r1);
  const Vec3d pad{q.x, q.y - 0.5 * len, q.z - 0.30 * r};
  return smooth_min(bone, ellipsoid(pad, {0.96 * r, 0.50 * len, 0.80 * r}), 0.35);
}

double DigitShape::knuckle(std::size_t i, const Vec3d& p) const {
  const double r = radius(i);
  const Vec3d q = bones_[i].to_local(p);
  const Vec3d bump{q.x, q.y + 0.05 * r, q.z + 0.22 * r};
  return ellipsoid(bump, {0.94 * r, 0.95 * r, 0.80 * r});
}

double DigitShape::tip(const Vec3d& p) const {
  const Vec3d q = bones_[2].to_local(p);
  const double len = lengths_[2], r0 = radius(2), r1 = radius(3);
  double d = kDepth * rounded_cone({q.x, q.y, q.z / kDepth}, 0.98 * r0, r1, len);
  const Vec3d pad{q.x, q.y - 0.62 * len, q.z - 0.26 * r0};
  d = smooth_min(d, ellipsoid(pad, {0.86 * r0, 0.60 * len, 0.70 * r0}), 0.3);
  return smooth_min(d, nail_plate(q), 0.05);
}

/// Outline in the tip's basis: a rounded rectangle, its root nearer the joint.
double DigitShape::outline(const Vec3d& q) const {
  const double half = 0.5 * profile_.nail_length;
  const double center = lengths_[2] + kNailEnd * radius(3) - half;
  const double corner = 0.72 * profile_.nail_width;
  const double x = std::max(std::abs(q.x) - (profile_.nail_width - corner), 0.0);
  const double y = std::max(std::abs(q.y - center) - (half - corner), 0.0);
  return std::sqrt(x * x + y * y) - corner;
}

double DigitShape::nail_plate(const Vec3d& q) const {
  // The upper part of a wide cylinder that dips towards the tip; the rest is within the finger.
  const double bend = 1.25 * profile_.nail_width;
  const double root = lengths_[2] - 0.5 * profile_.nail_length;
  const double back = 0.99 * radius(3) + 0.10 * (root + 0.25 - q.y);
  const double z = q.z + back - bend;
  const double cylinder = std::sqrt(q.x * q.x + z * z) - bend;
  return smooth_max(cylinder, std::max(outline(q), q.z), 0.06);
}

bool DigitShape::on_nail(const Vec3d& p) const {
  constexpr double kOnOutline = 0.03;  // the vertices along the outline are the nail's own
  const Vec3d q = bones_[2].to_local(p);
  return nail_outline(p) < kOnOutline && nail_plate(q) < kOnOutline;
}

double DigitShape::nail_outline(const Vec3d& p) const {
  const Vec3d q = bones_[2].to_local(p);
  return q.z < -0.1 * radius(3) ? outline(q) : 1.0;
}

double DigitShape::along_nail(const Vec3d& p) const {
  const double end = lengths_[2] + kNailEnd * radius(3);
  return 1 - (end - bones_[2].to_local(p).y) / profile_.nail_length;
}

}  // namespace mdk
