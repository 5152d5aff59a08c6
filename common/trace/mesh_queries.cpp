// All hits: a ray that meets a leaf's sixteen triangles has each of them tested alone, by the same
// test, so that none hides another.
//
// Closest point: a box in a cluster's basis is as far away, in the world, as it is there, divided
// by the most that local_from_world stretches anything. That bound needs no inverse, so that maps
// that are nearly singular only cost time. Boxes are visited by it, the nearest first; what the
// leaves hold is measured in double on the vertices as they are traced.
#include "common/trace/mesh_queries.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/motion/posed_mesh.h"
#include "common/trace/query_keys.h"
#include "common/trace/scaled_ray.h"

namespace mdk {
namespace {

/// What the kernels allow for, relative to the farthest coordinate, and then some.
constexpr double kSlack = 0x1p-18;

Affine3d map_at(const RayModel& model, const KeyInterval& at, std::uint32_t c) {
  const std::size_t k = model.clusters;
  return interpolate(model.local_from_world[at.key0 * k + c],
                     model.local_from_world[at.key1 * k + c], at.s);
}

/// Calls visit(triangle) for those of a leaf.
template <class Visit>
void for_each_triangle(const RayTree& tree, std::uint32_t leaf, Visit&& visit) {
  for (const RayBlock* block = tree.blocks + leaf;; ++block) {
    for (std::uint32_t i = 0; i < block->count; ++i) visit(block->triangle[i]);
    if (!block->has_next) return;
  }
}

// --- all hits ---

/// The ray in a cluster's basis. Boxes give way, on all sides, by what the triangle test's hits may
/// be off from the ray and by the rounding of the boxes.
class LocalRay {
 public:
  LocalRay(const WorldRay& ray, const Affine3d& local_from_world, const Aabb& bounds,
           double world_slack)
      : origin_(local_from_world.point(ray.origin)),
        t_begin_(std::min(0.0, static_cast<double>(ray.t_min))) {
    const Vec3d direction = local_from_world.vector(ray.direction);
    const double longest =
        std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    // A component so small moves the ray by less than the slack on its way to anything.
    const double shortest = std::max(longest * 0x1p-40, 1e-30);
    for (std::size_t k = 0; k < 3; ++k) {
      const double* row = local_from_world.m[k];
      const double stretch = std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]);
      const double size =
          std::abs(origin_[k]) + std::max(std::abs(static_cast<double>(bounds.lo[k])),
                                          std::abs(static_cast<double>(bounds.hi[k])));
      slack_[k] = stretch * world_slack + size * kSlack;
      const double d = direction[k];
      inverse_[k] = 1 / (std::abs(d) < shortest ? std::copysign(shortest, d) : d);
    }
  }

  bool meets(const Aabb& box, double t_max) const {
    double near = t_begin_, far = t_max;
    for (std::size_t k = 0; k < 3; ++k) {
      const double a = (static_cast<double>(box.lo[k]) - slack_[k] - origin_[k]) * inverse_[k];
      const double b = (static_cast<double>(box.hi[k]) + slack_[k] - origin_[k]) * inverse_[k];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    return near <= far;
  }

 private:
  Vec3d origin_, slack_, inverse_;
  double t_begin_;
};

/// One ray that collects hits.
class AllHits {
 public:
  AllHits(const ModelView& model, const HeldVertices& vertices, const ScaledRay& ray,
          std::vector<QueryHit>& hits)
      : model_(model), vertices_(vertices), ray_(ray), hits_(hits) {}

  void add_leaf(const RayTree& tree, std::uint32_t leaf) {
    batch_.count = 0;
    for_each_triangle(tree, leaf, [&](std::uint32_t t) {
      batch_.push(t, vertices_.placed(model_.triangles[t]));
      if (batch_.count == kBlockTriangles) flush();
    });
    flush();
  }

 private:
  RayHit test(TriangleBlock& block) const {
    block.pad();
    RayHit hit = ray_.nothing_yet();
    test_blocks(ray_.ray, {&block, 1}, vertices_.source(), hit);
    return hit;
  }
  void flush() {
    if (batch_.count > 0 && test(batch_).triangle != kNoHit) {
      for (std::uint32_t i = 0; i < batch_.count; ++i) {
        TriangleBlock alone;
        alone.push(batch_.triangle[i], vertices_.placed(model_.triangles[batch_.triangle[i]]));
        const RayHit hit = test(alone);
        if (hit.triangle != kNoHit) hits_.push_back(ray_.in_callers_lengths(hit));
      }
    }
    batch_.count = 0;
  }

  const ModelView& model_;
  const HeldVertices& vertices_;
  const ScaledRay& ray_;
  std::vector<QueryHit>& hits_;
  TriangleBlock batch_;
};

// --- closest point ---

/// No less than the most that the linear part stretches a vector: the 8th root of the Frobenius
/// norm of (A'A)^4, at most 3^(1/16) too large.
double largest_stretch(const Affine3d& a) {
  double m[3][3];
  double size = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) size = std::max(size, std::abs(a.m[i][j]));
  if (!(size > 0)) return 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      m[i][j] = 0;
      for (int k = 0; k < 3; ++k) m[i][j] += (a.m[k][i] / size) * (a.m[k][j] / size);
    }
  for (int round = 0; round < 2; ++round) {
    double square[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        square[i][j] = 0;
        for (int k = 0; k < 3; ++k) square[i][j] += m[i][k] * m[k][j];
      }
    std::copy(&square[0][0], &square[0][0] + 9, &m[0][0]);
  }
  double sum = 0;
  for (const auto& row : m)
    for (const double v : row) sum += v * v;
  return size * std::pow(sum, 1.0 / 16) * (1 + 1e-9);
}

double distance(const Vec3d& p, const Aabb& box) {
  double square = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double off = std::max(
        {static_cast<double>(box.lo[k]) - p[k], 0.0, p[k] - static_cast<double>(box.hi[k])});
    square += off * off;
  }
  return std::sqrt(square);
}

/// A part of the mesh that is still to be looked at, no nearer than `bound`.
struct Waiting {
  double bound;
  std::uint32_t cluster;
  WideBvhChild child;
};
constexpr auto kFartherFirst = [](const Waiting& a, const Waiting& b) { return a.bound > b.bound; };

/// A cluster's basis around the point.
struct LocalPoint {
  Vec3d p;
  double inverse_stretch = 0, slack = 0;
  bool known = false;

  double bound(const Aabb& box) const {
    return std::max(distance(p, box) - slack, 0.0) * inverse_stretch;
  }
};

LocalPoint make_local_point(const RayModel& model, const Vec3d& p, const KeyInterval& at,
                            std::uint32_t c, const Aabb& bounds) {
  const Affine3d map = map_at(model, at, c);
  LocalPoint local;
  local.p = map.point(p);
  const double stretch = largest_stretch(map);
  local.inverse_stretch = stretch > 0 ? 1 / stretch : 0;
  double size = 0;
  for (std::size_t k = 0; k < 3; ++k)
    size += std::abs(local.p[k]) + std::max(std::abs(static_cast<double>(bounds.lo[k])),
                                            std::abs(static_cast<double>(bounds.hi[k])));
  const double world =
      std::abs(p.x) + std::abs(p.y) + std::abs(p.z) + static_cast<double>(model.diagonal);
  local.slack = (size + stretch * world) * kSlack;
  local.known = true;
  return local;
}

}  // namespace

void find_all_hits(const RayTracer& tracer, const QueryRay& ray, const KeyInterval& at,
                   std::vector<QueryHit>& hits) {
  hits.clear();
  const ScaledRay scaled(ray);
  if (!scaled.usable) return;
  const RayModel& model = tracer.rays();
  const RayTree* trees = model.trees + std::size_t{tracer.segment_at(at)} * model.clusters;
  const HeldVertices vertices(tracer, at);
  AllHits all(tracer.model(), vertices, scaled, hits);
  const Vec3d& o = scaled.ray.origin;
  const Vec3d center = to_double(model.center);
  const double reach = std::abs(center.x - o.x) + std::abs(center.y - o.y) +
                       std::abs(center.z - o.z) + static_cast<double>(model.diagonal);
  const double t_max = static_cast<double>(scaled.nothing_yet().t);
  std::vector<std::uint32_t> stack;
  for (std::uint32_t c = 0; c < model.clusters; ++c) {
    const RayTree& tree = trees[c];
    if (tree.nodes.empty()) continue;
    const Aabb bounds = tree.nodes[0].box();
    const LocalRay local(scaled.ray, map_at(model, at, c), bounds, reach * kSlack);
    if (!local.meets(bounds, t_max)) continue;
    stack.assign(1, 0);
    while (!stack.empty()) {
      const auto& node = tree.nodes[stack.back()];
      stack.pop_back();
      for (std::uint32_t i = 0; i < node.count; ++i) {
        if (!local.meets(node.box(i), t_max)) continue;
        if (node.child[i].is_leaf()) {
          all.add_leaf(tree, node.child[i].index());
        } else {
          stack.push_back(node.child[i].index());
        }
      }
    }
  }
  std::ranges::sort(hits, [](const QueryHit& a, const QueryHit& b) {
    return a.t != b.t ? a.t < b.t : a.triangle < b.triangle;
  });
}

// The seven regions of Ericson, Real-Time Collision Detection, 5.1.5; a triangle without area is
// the longest of its edges.
TrianglePoint closest_on_triangle(const Vec3d& p, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const auto at = [&](double b1, double b2) {
    const Vec3d off = a + (b - a) * b1 + (c - a) * b2 - p;
    return TrianglePoint{dot(off, off), b1, b2};
  };
  // On the edge from b1, b2 to e1, e2.
  const auto on_edge = [&](const Vec3d& from, const Vec3d& to, double b1, double b2, double e1,
                           double e2) {
    const Vec3d along = to - from;
    const double square = dot(along, along);
    const double s = square > 0 ? std::clamp(dot(p - from, along) / square, 0.0, 1.0) : 0.0;
    return at(b1 + (e1 - b1) * s, b2 + (e2 - b2) * s);
  };
  const Vec3d ab = b - a, ac = c - a, ap = p - a;
  const Vec3d normal = cross(ab, ac);
  const double square = dot(normal, normal);
  if (square > 0) {
    const double b2 = dot(cross(ab, ap), normal) / square, b1 = dot(cross(ap, ac), normal) / square;
    if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1) return at(b1, b2);
  }
  TrianglePoint best = on_edge(a, b, 0, 0, 1, 0);
  for (const TrianglePoint& other : {on_edge(a, c, 0, 0, 0, 1), on_edge(b, c, 1, 0, 0, 1)})
    if (other.square < best.square) best = other;
  return best;
}

QueryHit find_closest_point(const RayTracer& tracer, const Vec3f& point, float radius,
                            const KeyInterval& at) {
  const RayModel& model = tracer.rays();
  const ModelView& mesh = tracer.model();
  const RayTree* trees = model.trees + std::size_t{tracer.segment_at(at)} * model.clusters;
  const HeldVertices vertices(tracer, at);
  const Vec3d p = to_double(point);

  QueryHit best;
  best.t = radius;
  std::vector<LocalPoint> locals(model.clusters);
  std::vector<Waiting> heap;
  const auto push = [&](const Waiting& part) {
    if (part.bound > static_cast<double>(best.t)) return;
    heap.push_back(part);
    std::ranges::push_heap(heap, kFartherFirst);
  };
  double reach = static_cast<double>(model.diagonal);
  for (std::size_t k = 0; k < 3; ++k)
    reach += std::abs(p[k]) + std::abs(static_cast<double>(model.center[k]));
  for (std::uint32_t c = 0; c < model.clusters; ++c) {
    if (trees[c].nodes.empty()) continue;
    const double bound = distance(p, cluster_world_box(mesh, c, at)) - reach * kSlack;
    push({std::max(bound, 0.0), c, WideBvhChild::inner(0)});
  }
  while (!heap.empty()) {
    std::ranges::pop_heap(heap, kFartherFirst);
    const Waiting next = heap.back();
    heap.pop_back();
    if (next.bound > static_cast<double>(best.t)) break;
    const RayTree& tree = trees[next.cluster];
    if (!locals[next.cluster].known)
      locals[next.cluster] = make_local_point(model, p, at, next.cluster, tree.nodes[0].box());
    if (!next.child.is_leaf()) {
      const auto& node = tree.nodes[next.child.index()];
      for (std::uint32_t i = 0; i < node.count; ++i)
        push({locals[next.cluster].bound(node.box(i)), next.cluster, node.child[i]});
      continue;
    }
    for_each_triangle(tree, next.child.index(), [&](std::uint32_t t) {
      Vec3d corner[3];
      for (int k = 0; k < 3; ++k) corner[k] = to_double(vertices.position(mesh.triangles[t].v[k]));
      const TrianglePoint q = closest_on_triangle(p, corner[0], corner[1], corner[2]);
      const auto d = static_cast<float>(std::sqrt(q.square));
      // Nothing is closer than a radius of infinity, but what is at the radius counts.
      const bool is_first = best.triangle == kNoTriangle && d <= best.t;
      if (!is_first && !(d < best.t || (d == best.t && t < best.triangle))) return;
      if (!std::isfinite(d)) return;
      best = {d, t, static_cast<float>(q.bary1), static_cast<float>(q.bary2)};
    });
  }
  return best.triangle == kNoTriangle ? QueryHit{} : best;
}

}  // namespace mdk
