// Distance fields of simple solids and smooth ways to join them: negative inside, positive outside.
// Only + - * / and sqrt are used, which every IEEE machine rounds alike, so a mesh made from such a
// field has the same bits everywhere.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/math/vec3.h"

namespace mdk {

/// Distance (or a bound that is right near the surface) from a point to a solid.
using DistanceField = std::function<double(const Vec3d&)>;

/// An orthonormal, right-handed basis in space; `y` runs along a bone.
struct Basis {
  Vec3d origin;
  Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  Vec3d vector_to_local(const Vec3d& v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  Vec3d vector_to_world(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3d to_local(const Vec3d& p) const { return vector_to_local(p - origin); }
  Vec3d to_world(const Vec3d& p) const { return origin + vector_to_world(p); }
};

/// The basis at `origin` whose y runs along `along` and whose z is as near to `front` as can be.
inline Basis basis_along(const Vec3d& origin, const Vec3d& along, const Vec3d& front) {
  const Vec3d y = normalized(along);
  const Vec3d x = normalized(cross(y, front));
  return {origin, x, y, cross(x, y)};
}

/// Signed distance to the hull of two balls, of radius `r0` at the origin and `r1` at height `h` on
/// the y axis; |r0 - r1| < h.
inline double rounded_cone(const Vec3d& p, double r0, double r1, double h) {
  const double radial = std::sqrt(p.x * p.x + p.z * p.z);
  const double slope = (r0 - r1) / h;
  const double rise = std::sqrt(1 - slope * slope);
  const double along = p.y * rise - radial * slope;
  if (along < 0) return length(p) - r0;
  if (along > rise * h) return std::sqrt(radial * radial + (p.y - h) * (p.y - h)) - r1;
  return radial * rise + p.y * slope - r0;
}

/// The same between two points in space.
inline double rounded_cone_between(const Vec3d& p, const Vec3d& a, double ra, const Vec3d& b,
                                   double rb) {
  const Vec3d axis = b - a;
  const double h = length(axis);
  const Vec3d y = axis * (1 / h);
  const Vec3d q = p - a;
  const double along = dot(q, y);
  const double radial = length(q - y * along);
  return rounded_cone({radial, along, 0}, ra, rb, h);
}

/// Near-distance to an axis-aligned ellipsoid about the origin with the given half-axes.
inline double ellipsoid(const Vec3d& p, const Vec3d& radii) {
  const Vec3d unit{p.x / radii.x, p.y / radii.y, p.z / radii.z};
  const Vec3d slope{unit.x / radii.x, unit.y / radii.y, unit.z / radii.z};
  const double k0 = length(unit), k1 = length(slope);
  if (k1 == 0) return -std::min({radii.x, radii.y, radii.z});
  return k0 * (k0 - 1) / k1;
}

/// Union that rounds the seam over a width of about `k` (twice differentiable).
inline double smooth_min(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * h * k * (1.0 / 6.0);
}
/// Intersection that rounds the seam likewise.
inline double smooth_max(double a, double b, double k) { return -smooth_min(-a, -b, k); }

/// 0 below `from`, 1 above `to`, smooth between.
inline double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// The field's gradient by central differences over `step` to each side.
inline Vec3d gradient(const DistanceField& field, const Vec3d& p, double step) {
  const double s = 0.5 / step;
  return {(field({p.x + step, p.y, p.z}) - field({p.x - step, p.y, p.z})) * s,
          (field({p.x, p.y + step, p.z}) - field({p.x, p.y - step, p.z})) * s,
          (field({p.x, p.y, p.z + step}) - field({p.x, p.y, p.z - step})) * s};
}

}  // namespace mdk
