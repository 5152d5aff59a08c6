// What programs ask of a moving mesh beside the closest hit: every hit along a ray, and the closest
// point. Both go down the hierarchies that RayTracer has, one box at a time.
#pragma once

#include <vector>

#include "common/trace/ray_tracer.h"
#include "mdk/ray_query.h"

namespace mdk {

/// Every hit in (t_min, t_max], ascending by t, then by triangle: those that the closest hit is the
/// first of. `hits` is made empty first. Cost: that of a ray that meets nothing early, and a test
/// of sixteen triangles for each leaf that has a hit.
void find_all_hits(const RayTracer& tracer, const QueryRay& ray, const KeyInterval& at,
                   std::vector<QueryHit>& hits);

/// The closest point of the mesh within `radius`, ties to the lower triangle; its t is the
/// distance, computed in double and rounded once. Brute force over closest_on_triangle() gives the
/// same bits.
QueryHit find_closest_point(const RayTracer& tracer, const Vec3f& point, float radius,
                            const KeyInterval& at);

/// The same of one triangle, whatever its shape.
struct TrianglePoint {
  double square;  ///< of the distance
  double bary1, bary2;
};
TrianglePoint closest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c);

}  // namespace mdk
