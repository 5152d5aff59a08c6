#include <algorithm>
#include <cmath>

#include "common/trace/kernels/beam_kernels.h"

namespace mdk {
namespace {

double sum(const Vec3d& v) { return v.x + v.y + v.z; }

/// How far coordinates of points in the box may be from 0.
Vec3d reach_of(const Aabb& box) {
  Vec3d reach;
  for (std::size_t axis = 0; axis < 3; ++axis)
    reach[axis] = std::max(std::abs(static_cast<double>(box.lo[axis])),
                           std::abs(static_cast<double>(box.hi[axis])));
  return reach;
}

}  // namespace

BeamSpace make_beam_space(const Affine3d& local_from_world, const Aabb& bounds, const Aabb& mesh) {
  BeamSpace space;
  space.local_from_world = local_from_world;
  const Vec3d x = local_from_world.column(0), y = local_from_world.column(1),
              z = local_from_world.column(2);
  // A mirrored basis turns every sign; the forms are to have the world's.
  const double det = local_from_world.determinant(), side = det < 0 ? -1.0 : 1.0;
  space.cofactor[0] = cross(y, z) * side;
  space.cofactor[1] = cross(z, x) * side;
  space.cofactor[2] = cross(x, y) * side;
  space.det = det * side;
  // The products cancel where a map is near singular; what is lost is relative to their factors.
  space.rounding =
      0x1p-46 * (length(x) * length(y) + length(y) * length(z) + length(z) * length(x));
  space.reach = reach_of(bounds);
  space.world_reach = mesh.empty() ? 0.0 : sum(to_double(mesh.hi) - to_double(mesh.lo));
  return space;
}

}  // namespace mdk
