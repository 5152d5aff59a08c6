#include "common/trace/kernels/ray_bounds.h"

#include <algorithm>
#include <cmath>

namespace mdk {
namespace {

/// Past this, products with coordinates might overflow: such a form tells nothing.
constexpr double kLargestForm = 1e30;

/// The products of the pinhole's vectors that all bounds of a frame are made of, in double.
struct FrustumBasis {
  Vec3d origin;
  Vec3d corner_x_dv, du_x_corner, du_x_dv;  ///< cross products
  double det = 0;          ///< of (corner, du, dv); its sign tells a mirrored basis
  double plane_error = 0;  ///< bounds the rounding of a side plane's normal, per component
  double depth_error = 0;  ///< the same for the gradient of the depth
};

FrustumBasis make_basis(const PinholeRays& rays, const Affine3d& local_from_world) {
  const Vec3d corner = local_from_world.vector(to_double(rays.corner));
  const Vec3d du = local_from_world.vector(to_double(rays.du));
  const Vec3d dv = local_from_world.vector(to_double(rays.dv));
  FrustumBasis basis;
  basis.origin = local_from_world.point(to_double(rays.origin));
  basis.corner_x_dv = cross(corner, dv);
  basis.du_x_corner = cross(du, corner);
  basis.du_x_dv = cross(du, dv);
  basis.det = dot(corner, basis.du_x_dv);

  // The products cancel where a map is near singular; what is lost is relative to their factors.
  constexpr double kRounding = 0x1p-46;
  const double c = length(corner), u = length(du), v = length(dv);
  basis.plane_error = kRounding * (c * (u + v) + kMaxImageSide * u * v);
  const double det = std::abs(basis.det);
  basis.depth_error = kRounding * (u * v + length(basis.du_x_dv) / det * c * u * v) / det;
  return basis;
}

Vec3d absolute(const Vec3d& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }

double largest_of(const Vec3d& v) { return std::max({v.x, v.y, v.z}); }

/// Sides through the eye whose normal is `base` + place * `step`.
void set_side(FrustumForms& forms, int side, const Vec3d& base, const Vec3d& step,
              const FrustumBasis& basis, const Vec3d& reach, double before) {
  // Relative to |base| + place |step|, in units of 2^-24: a float normal is off by 4 (two
  // roundings, a product, a sum), its offset by as much; products and sums over a box by 5; the
  // triangle test's own view of the corners (offset from the eye, pixel space) by 6. 2^-19 is 32.
  constexpr double kRounding = 0x1p-19;
  const double error = basis.plane_error * (reach.x + reach.y + reach.z);
  const double w_base = -dot(base, basis.origin) + error +
                        kRounding * dot(absolute(base) + absolute(step) * (2 * before), reach);
  const double w_step = -dot(step, basis.origin) + kRounding * dot(absolute(step), reach);
  const bool usable =
      largest_of(absolute(base) + absolute(step) * double{kMaxImageSide}) < kLargestForm &&
      std::abs(w_base) + std::abs(w_step) * kMaxImageSide < kLargestForm;
  for (std::size_t axis = 0; axis < 4; ++axis) {
    const double b = axis < 3 ? base[axis] : w_base, s = axis < 3 ? step[axis] : w_step;
    const std::size_t i = axis * kSides + static_cast<std::size_t>(side);
    forms.base[i] = usable ? static_cast<float>(b) : 0.0f;
    forms.step[i] = usable ? static_cast<float>(s) : 0.0f;
  }
}

void set_depth(FrustumForms& forms, const FrustumBasis& basis, const Aabb& bounds,
               const Vec3d& reach) {
  const Vec3d depth = basis.du_x_dv * (1.0 / basis.det);  // t of a point p is depth.(p - origin)
  const double offset = -dot(depth, basis.origin);
  const double slack = dot(absolute(depth) * 0x1p-19 + Vec3d{1, 1, 1} * basis.depth_error, reach);
  const bool usable =
      largest_of(absolute(depth)) < kLargestForm && std::abs(offset) + slack < kLargestForm;
  if (!usable) {
    forms.depth = {0, 0, 0};
    forms.depth_offset = 0;
    forms.front_offset = 0;
    forms.in_front = true;  // for all that can be told
    return;
  }
  forms.depth = to_float(depth);
  forms.depth_offset = static_cast<float>(offset - slack);
  forms.front_offset = static_cast<float>(offset + slack);
  double nearest = offset - slack;
  for (std::size_t axis = 0; axis < 3; ++axis)
    nearest += std::min(depth[axis] * bounds.lo[axis], depth[axis] * bounds.hi[axis]);
  forms.in_front = nearest > 0;
}

/// How far coordinates of points in the box may be from 0.
Vec3d reach_of(const Aabb& box) {
  const Vec3d lo = absolute(to_double(box.lo)), hi = absolute(to_double(box.hi));
  return {std::max(lo.x, hi.x), std::max(lo.y, hi.y), std::max(lo.z, hi.z)};
}

}  // namespace

FrustumForms make_frustum_forms(const PinholeRays& world_rays, const Affine3d& local_from_world,
                                const Aabb& bounds, double before) {
  const FrustumBasis basis = make_basis(world_rays, local_from_world);
  FrustumForms forms;
  // How far coordinates and the eye reach from the origin: what roundings are relative to.
  const Vec3d reach = absolute(basis.origin) + reach_of(bounds);
  const double side = basis.det < 0 ? -1.0 : 1.0;
  // n.(ray through X) = det (x - X) for the plane at x: left sides take -n, right sides n.
  set_side(forms, 0, basis.corner_x_dv * -side, basis.du_x_dv * -side, basis, reach, before);
  set_side(forms, 1, basis.corner_x_dv * side, basis.du_x_dv * side, basis, reach, before);
  set_side(forms, 2, basis.du_x_corner * -side, basis.du_x_dv * -side, basis, reach, before);
  set_side(forms, 3, basis.du_x_corner * side, basis.du_x_dv * side, basis, reach, before);
  set_depth(forms, basis, bounds, reach);
  forms.eye = to_float(basis.origin);
  return forms;
}

void loosen(FrustumForms& forms, float distance) {
  for (std::size_t side = 0; side < kSides; ++side) {
    float base = 0, step = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      base += std::abs(forms.base[axis * kSides + side]);
      step += std::abs(forms.step[axis * kSides + side]);
    }
    forms.base[3 * kSides + side] += base * distance;
    forms.step[3 * kSides + side] += step * distance;
  }
  const float depth =
      (std::abs(forms.depth.x) + std::abs(forms.depth.y) + std::abs(forms.depth.z)) * distance;
  forms.depth_offset -= depth;
  forms.front_offset += depth;
  if (depth > 0) forms.in_front = false;
}

BeamSpace make_beam_space(const Affine3d& local_from_world, const Aabb& bounds, const Aabb& mesh) {
  BeamSpace space;
  const Vec3d x = local_from_world.column(0), y = local_from_world.column(1),
              z = local_from_world.column(2);
  // A mirrored basis turns every sign; the forms are to have the world's.
  const double det = local_from_world.determinant(), side = det < 0 ? -1.0 : 1.0;
  space.cofactor[0] = cross(y, z) * side;
  space.cofactor[1] = cross(z, x) * side;
  space.cofactor[2] = cross(x, y) * side;
  space.det = det * side;
  // As in make_basis().
  space.rounding =
      0x1p-46 * (length(x) * length(y) + length(y) * length(z) + length(z) * length(x));
  space.reach = reach_of(bounds);
  if (!mesh.empty()) {
    const Vec3d extent = to_double(mesh.hi) - to_double(mesh.lo);
    space.world_reach = extent.x + extent.y + extent.z;
  }
  return space;
}

}  // namespace mdk
