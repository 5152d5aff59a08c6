// What a tile carries down a structure: its frustum, which culls boxes, and the depth of its
// farthest hit. Triangles of the leaves entered are tested sixteen at a time.
#include "common/trace/kernels/tile_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/tile_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/tile_image-inl.h"
#include "common/trace/kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace tiles {

/// Counts work, or compiles to nothing.
struct Counting {
  TraceCounters& counters;
  void nodes(std::uint64_t n) const { counters.node_visits += n; }
  void clusters(std::uint64_t n) const { counters.clusters_entered += n; }
  void candidates(std::uint64_t n) const { counters.leaf_triangles += n; }
  void tests(std::uint64_t n) const { counters.triangle_tests += n; }
};
struct NoCounting {
  void nodes(std::uint64_t) const {}
  void clusters(std::uint64_t) const {}
  void candidates(std::uint64_t) const {}
  void tests(std::uint64_t) const {}
};

/// Blocks of triangles against one tile.
template <class Counter>
class BlockTester {
 public:
  BlockTester(const TileRays& tile, const Vec3f* positions, const Counter& counter)
      : tile_(tile), positions_(positions), counter_(counter), image_(tile) {}

  const TileRays& tile() const { return tile_; }
  const TileImage& image() const { return image_; }
  const Counter& counter() const { return counter_; }

  /// A block no one keeps: only what may be hit in this tile is projected.
  void test(const TriangleBlock& block, ProjectedBlock& projected) {
    counter_.candidates(block.count);
    Projector projector(block, *tile_.pixel_from_world, positions_, projected);
    projector.run([&](std::size_t i) { return image_.may_hit(projected, i); });
    finish(block, projected, projected.live);
  }

  /// A block that serves the whole frame.
  void test(const TriangleBlock& block, std::uint32_t number, ProjectionCache& cache,
            ProjectedBlock& spare) {
    const FloatTag d;
    const ProjectedBlock& projected = cache.get(number, spare, [&](ProjectedBlock& out) {
      Projector projector(block, *tile_.pixel_from_world, positions_, out);
      projector.run([&](std::size_t) { return hn::Eq(hn::Zero(d), hn::Zero(d)); });
    });
    counter_.candidates(block.count);
    if (projected.live == 0) return;
    std::uint32_t mask = 0;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::Lanes(d))
      mask |= mask_bits(d, image_.may_hit(projected, i)) << i;
    finish(block, projected, mask & projected.live);
  }

 private:
  void finish(const TriangleBlock& block, const ProjectedBlock& projected, std::uint32_t mask) {
    if ((mask & projected.behind) != 0) mask &= ~missed_by_sides(block, projected.behind);
    if (mask != 0) counter_.tests(image_.test(block, projected, mask));
  }

  /// Of the triangles in `behind`, those with all corners on the outer side of one of the tile's
  /// four planes: where a triangle reaches behind the eye, this stands for its bounds.
  std::uint32_t missed_by_sides(const TriangleBlock& block, std::uint32_t behind) const {
    const FloatTag d;
    std::uint32_t missed = 0;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::Lanes(d)) {
      const Corners p = gather_corners(block, i, *tile_.pixel_from_world, positions_);
      const auto one_side = [&](FloatVec a, FloatVec b, FloatVec c, std::uint32_t first) {
        const auto offset = [&](FloatVec coordinate, FloatVec depth, std::uint32_t edge) {
          return hn::Sub(coordinate, hn::Mul(depth, hn::Set(d, static_cast<float>(edge))));
        };
        const std::uint32_t last = first + kTileSide;
        const auto below = hn::Max(hn::Max(offset(a, p.a.z, first), offset(b, p.b.z, first)),
                                   offset(c, p.c.z, first));
        const auto above = hn::Min(hn::Min(offset(a, p.a.z, last), offset(b, p.b.z, last)),
                                   offset(c, p.c.z, last));
        return hn::Or(hn::Lt(below, hn::Zero(d)), hn::Gt(above, hn::Zero(d)));
      };
      missed |= mask_bits(d, hn::Or(one_side(p.a.x, p.b.x, p.c.x, tile_.x),
                                    one_side(p.a.y, p.b.y, p.c.y, tile_.y)))
                << i;
    }
    return missed & behind;
  }

  const TileRays& tile_;
  const Vec3f* positions_;
  Counter counter_;
  TileImage image_;
};

/// A tile's frustum on its way down one tree (walk-inl.h): the four sides as forms, and the depth
/// over boxes, which is least at the corner the depth's gradient picks.
template <class Counter>
class TileInTree {
 public:
  struct Cell : BoxForms<kSides>::Cell {
    float nearest[3];  ///< what each axis adds to the least depth
  };

  TileInTree(const FrustumForms& forms, const BlockTester<Counter>& tester)
      : forms_(forms), tester_(tester) {
    const hn::CappedTag<float, 4 * kSides> d;
    const TileRays& tile = tester.tile();
    const float x = static_cast<float>(tile.x), y = static_cast<float>(tile.y);
    constexpr float kSide = kTileSide;
    alignas(64)
        const float place[4 * kSides] = {x, x + kSide, y, y + kSide, x, x + kSide, y, y + kSide,
                                         x, x + kSide, y, y + kSide, x, x + kSide, y, y + kSide};
    for (std::size_t i = 0; i < 4 * kSides; i += hn::Lanes(d))
      hn::Store(hn::MulAdd(hn::Load(d, forms.step + i), hn::Load(d, place + i),
                           hn::Load(d, forms.base + i)),
                d, sides_.row(0) + i);
    sides_.choose_corners();
    for (std::size_t axis = 0; axis < 3; ++axis)
      near_plane_[axis] = static_cast<std::uint8_t>(2 * axis + (forms.depth[axis] < 0));
  }

  /// Not those outside, nor those farther than all hits; `depth` gets each child's least depth.
  HWY_INLINE std::uint32_t enter(const WideBvhNode& node, float (&depth)[kBvhWidth]) const {
    tester_.counter().nodes(node.count);
    const hn::CappedTag<float, kBvhWidth> d;
    const float farthest = tester_.image().farthest();
    std::uint32_t entered = 0;
    for (std::size_t i = 0; i < kBvhWidth; i += hn::Lanes(d)) {
      const auto plane = [&](std::size_t r) { return hn::Load(d, node.bounds[r] + i); };
      const auto largest = [&](std::size_t k) { return sides_.largest(d, node.bounds, i, k); };
      const auto least = hn::Min(hn::Min(largest(0), largest(1)), hn::Min(largest(2), largest(3)));
      const auto least_depth = depth_at(d, plane(near_plane_[0]), plane(near_plane_[1]),
                                        plane(near_plane_[2]), forms_.depth_offset);
      hn::Store(least_depth, d, depth + i);
      auto outside = hn::Or(hn::Lt(least, hn::Zero(d)), hn::Gt(least_depth, hn::Set(d, farthest)));
      if (!forms_.in_front) {
        const auto deepest = depth_at(d, plane(near_plane_[0] ^ 1u), plane(near_plane_[1] ^ 1u),
                                      plane(near_plane_[2] ^ 1u), forms_.front_offset);
        outside = hn::Or(outside, hn::Lt(deepest, hn::Zero(d)));
      }
      entered |= mask_bits(d, hn::Not(outside)) << i;
    }
    return entered & ((1u << node.count) - 1);
  }
  HWY_INLINE bool is_past(float depth) const { return depth > tester_.image().farthest(); }

  HWY_INLINE void set_axis(Cell& cell, std::size_t axis, float lo, float hi) const {
    sides_.set_axis(cell, axis, lo, hi);
    cell.nearest[axis] = forms_.depth[axis] * (forms_.depth[axis] < 0 ? hi : lo);
  }
  HWY_INLINE bool misses(const Cell& cell) const {
    tester_.counter().nodes(1);
    return is_missed(cell);
  }
  /// Whether it misses a tree as a whole: looked at before a cluster is posed, and not counted.
  HWY_INLINE bool misses_all(const KdTreeView& tree) const {
    return is_missed(root_cell(*this, tree.bounds));
  }
  bool below_first(std::uint32_t axis, float split) const { return forms_.eye[axis] <= split; }

  static constexpr bool finished() { return false; }

 private:
  /// Outside, or farther than all hits.
  HWY_INLINE bool is_missed(const Cell& cell) const {
    if (sides_.is_outside(cell)) return true;
    const float depth = cell.nearest[0] + cell.nearest[1] + cell.nearest[2];
    if (depth + forms_.depth_offset > tester_.image().farthest()) return true;
    if (forms_.in_front) return false;
    float deepest = forms_.front_offset;
    for (std::size_t axis = 0; axis < 3; ++axis)
      deepest += forms_.depth[axis] * (forms_.depth[axis] < 0 ? cell.lo[axis] : cell.hi[axis]);
    return deepest < 0;
  }

  template <class D, class V>
  HWY_INLINE V depth_at(D d, V x, V y, V z, float offset) const {
    const Vec3f& n = forms_.depth;
    return hn::MulAdd(
        hn::Set(d, n.x), x,
        hn::MulAdd(hn::Set(d, n.y), y, hn::MulAdd(hn::Set(d, n.z), z, hn::Set(d, offset))));
  }

  const FrustumForms& forms_;
  const BlockTester<Counter>& tester_;
  BoxForms<kSides> sides_;
  std::uint8_t near_plane_[3];
};

/// What a trace needs at hand.
template <class Counter>
struct TileTrace {
  const TraceScene& scene;
  BlockTester<Counter>& tester;
  TileScratch& scratch;

  TileInTree<Counter> rays_in(const FrustumForms& forms) const { return {forms, tester}; }
};

template <class Counter>
void trace(const TileTrace<Counter>& t, std::monostate) {
  const auto test = [&](const TriangleBlock& block) { t.tester.test(block, t.scratch.block); };
  TriangleBatch batch(t.scene.triangles, test);
  for (std::uint32_t i = 0; i < t.scene.triangle_count; ++i) batch.push(i);
  batch.flush();
}

template <class Counter>
void test_leaf(const TileTrace<Counter>& t, std::uint32_t number) {
  const TriangleBlock& block = t.scene.blocks[number];
  if (t.scene.projected_blocks != nullptr) {
    t.tester.test(block, number, *t.scene.projected_blocks, t.scratch.block);
  } else {
    t.tester.test(block, t.scratch.block);
  }
}

template <class Counter>
void trace(const TileTrace<Counter>& t, const BvhLevels& levels) {
  const auto test_leaves = [&](const TreeLevel<BvhView>& level) {
    const auto rays = t.rays_in(level.forms);
    walk_bvh(level.tree.nodes, rays,
             [&](std::uint32_t leaf) { test_leaf(t, level.tree.first_leaf + leaf); });
  };
  if (levels.clusters.empty()) return test_leaves(levels.top);
  const auto rays = t.rays_in(levels.top.forms);
  walk_bvh(levels.top.tree.nodes, rays, [&](std::uint32_t leaf) {
    t.tester.counter().clusters(1);
    const std::uint32_t c = levels.cluster_of_leaf[leaf];
    t.scene.mesh->require(c);
    test_leaves(levels.clusters[c]);
  });
}

template <class Counter>
void trace(const TileTrace<Counter>& t, const KdLevels& levels) {
  t.scratch.begin_tile(t.scene.triangle_count, levels.clusters.size());
  Mailbox seen_triangles(t.scratch.triangle_stamps, t.scratch.serial);
  Mailbox seen_clusters(t.scratch.cluster_stamps, t.scratch.serial);
  const auto test = [&](const TriangleBlock& block) { t.tester.test(block, t.scratch.block); };
  TriangleBatch batch(t.scene.triangles, test);
  const auto test_leaves = [&](const KdTreeView& tree, const TileInTree<Counter>& rays) {
    walk_kd(tree, rays, [&](std::uint32_t triangle) {
      if (seen_triangles.is_new(triangle)) batch.push(triangle);
    });
  };
  const auto top = t.rays_in(levels.top.forms);
  if (levels.clusters.empty()) {
    test_leaves(levels.top.tree, top);
  } else {
    walk_kd(levels.top.tree, top, [&](std::uint32_t c) {
      if (!seen_clusters.is_new(c)) return;
      const TreeLevel<KdTreeView>& cluster = levels.clusters[c];
      const auto rays = t.rays_in(cluster.forms);
      if (rays.misses_all(cluster.tree)) return;
      t.tester.counter().clusters(1);
      t.scene.mesh->require(c);
      test_leaves(cluster.tree, rays);
    });
  }
  batch.flush();
}

/// Traces with counting or without, then stores what was hit, if anything.
template <class Counter, class Structure>
HWY_NOINLINE bool trace_and_store(const TileRays& tile, const TraceScene& scene,
                                  const Structure& structure, TileHits& hits, TileScratch& scratch,
                                  Counter counter) {
  BlockTester<Counter> tester(tile, scene.positions, counter);
  trace(TileTrace<Counter>{scene, tester, scratch}, structure);
  if (tester.image().empty()) return false;
  tester.image().store(hits);
  return true;
}

bool TraceTile(const TileRays& tile, const TraceScene& scene, TileHits& hits, TileScratch& scratch,
               TraceCounters* counters) {
  const auto with = [&](const auto& structure) {
    if (counters == nullptr)
      return trace_and_store(tile, scene, structure, hits, scratch, NoCounting{});
    return trace_and_store(tile, scene, structure, hits, scratch, Counting{*counters});
  };
  if (const auto* bvh = std::get_if<BvhLevels>(&scene.structure)) return with(*bvh);
  if (const auto* kd = std::get_if<KdLevels>(&scene.structure)) return with(*kd);
  return with(std::monostate());
}

}  // namespace tiles
using tiles::TraceTile;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(TraceTile);

bool trace_tile(const TileRays& tile, const TraceScene& scene, TileHits& hits, TileScratch& scratch,
                TraceCounters* counters) {
  return HWY_DYNAMIC_DISPATCH(TraceTile)(tile, scene, hits, scratch, counters);
}

PixelFromWorld make_pixel_from_world(const PinholeRays& rays) {
  // The inverse of the matrix with columns (du, dv, corner).
  const Vec3d corner = to_double(rays.corner), du = to_double(rays.du), dv = to_double(rays.dv);
  const Vec3d rows[3] = {cross(dv, corner), cross(corner, du), cross(du, dv)};
  const double det = dot(corner, rows[2]);
  PixelFromWorld result;
  result.origin = rays.origin;
  for (int i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) result.m[i][j] = static_cast<float>(rows[i][j] / det);
  return result;
}

void TileScratch::begin_tile(std::size_t triangles, std::size_t clusters) {
  triangle_stamps.resize(triangles, 0);
  cluster_stamps.resize(clusters, 0);
  if (++serial == 0) {  // wrapped round: old stamps would look new
    triangle_stamps.assign(triangles, 0);
    cluster_stamps.assign(clusters, 0);
    serial = 1;
  }
}

}  // namespace mdk
#endif  // HWY_ONCE
