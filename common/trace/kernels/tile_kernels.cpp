// A tile of rays through the structures of one model. Triangles of the leaves entered are tested
// sixteen at a time.
#include "common/trace/kernels/tile_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/tile_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/tile_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace tiles {

/// Blocks of triangles against one tile.
template <class Counter>
class BlockTester {
 public:
  BlockTester(const TileRays& tile, const Vec3f* positions, const Counter& counter)
      : tile_(tile), positions_(positions), counter_(counter), image_(tile) {}

  TileEdges edges() const { return edges_of(tile_); }
  float farthest() const { return image_.farthest(); }
  const TileImage& image() const { return image_; }
  const Counter& counter() const { return counter_; }

  /// A block no one keeps: only what may be hit in this tile is projected.
  void test(const TriangleBlock& block, ProjectedBlock& projected) {
    counter_.candidates(block.count);
    const IndexedCorners corners{block, *tile_.pixel_from_world, positions_};
    Projector projector(block.count, corners, tile_.pixel_from_world->margin, projected);
    projector.run([&](std::size_t i) { return image_.may_hit(projected, i); });
    finish(block, projected, projected.live);
  }

  /// A block that serves the whole frame.
  void test(const TriangleBlock& block, std::uint32_t number, ProjectionCache& cache,
            ProjectedBlock& spare) {
    const FloatTag d;
    const ProjectedBlock& projected = cache.get(number, spare, [&](ProjectedBlock& out) {
      const IndexedCorners corners{block, *tile_.pixel_from_world, positions_};
      Projector projector(block.count, corners, tile_.pixel_from_world->margin, out);
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
    if ((mask & projected.behind) != 0)
      mask &= ~missed_by_sides(edges(), IndexedCorners{block, *tile_.pixel_from_world, positions_},
                               projected.behind);
    if (mask != 0) counter_.tests(image_.test(block.triangle, projected, mask));
  }

  const TileRays& tile_;
  const Vec3f* positions_;
  Counter counter_;
  TileImage image_;
};

/// What a trace needs at hand.
template <class Counter>
struct TileTrace {
  const TraceScene& scene;
  BlockTester<Counter>& tester;
  TileScratch& scratch;

  TileInTree<BlockTester<Counter>> rays_in(const FrustumForms& forms) const {
    return {forms, tester};
  }
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
  const auto test_leaves = [&](const KdTreeView& tree,
                               const TileInTree<BlockTester<Counter>>& rays) {
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
