// How a tile walks a structure: cells and boxes are tested with the tile's frustum, near ones
// first; triangles met in leaves are tested sixteen at a time.
#include "common/trace/kernels/tile_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/tile_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/block_tester-inl.h"
#include "common/trace/kernels/frustum-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {

/// Walks a kd-tree (inverse frustum culling, RSH05): the cell shrinks on the way down, and is
/// tested whole. Calls visit(reference) for what stands in the leaves met, near leaves first.
template <class Counter, class Visit>
void walk_kd(const KdTreeView& tree, const TileFrustum& frustum, const BlockTester<Counter>& tester,
             const Visit& visit) {
  if (tree.nodes.empty()) return;
  TileFrustum::Cell stack[kMaxKdDepth + 2];
  std::size_t size = 0;
  stack[size++] = frustum.cell_of(tree.bounds, 0);
  while (size > 0) {
    TileFrustum::Cell& cell = stack[size - 1];
    tester.counter().nodes(1);
    if (frustum.misses(cell, tester.image().farthest())) {
      --size;
      continue;
    }
    const KdNode node = tree.nodes[cell.node];
    if (node.is_leaf()) {
      --size;
      for (std::uint32_t i = 0; i < node.ref_count(); ++i) visit(tree.refs[node.first_ref() + i]);
      continue;
    }
    // The far child takes the cell's place, the near one comes on top of it.
    const std::uint32_t axis = node.axis();
    const bool below_first = frustum.below_first(axis, node.split());
    TileFrustum::Cell& next = stack[size++] = cell;
    TileFrustum::Cell& below = below_first ? next : cell;
    TileFrustum::Cell& above = below_first ? cell : next;
    below.node = node.below();
    above.node = node.above();
    frustum.set_axis(below, axis, below.lo[axis], node.split());
    frustum.set_axis(above, axis, node.split(), above.hi[axis]);
  }
}

/// A child that waits to be visited, and the depth its box begins at.
struct Waiting {
  float depth;
  WideBvhChild child;
};

/// Adds the children in `met`, nearest on top. Returns the new size.
HWY_INLINE std::size_t push_nearest_last(const WideBvhNode& node, std::uint32_t met,
                                         const float (&depth)[kBvhWidth], Waiting* stack,
                                         std::size_t size) {
  const std::size_t bottom = size;
  for (; met != 0; met &= met - 1) {
    const auto c = static_cast<std::size_t>(__builtin_ctz(met));
    const Waiting entry{depth[c], node.child[c]};
    std::size_t at = size++;
    for (; at > bottom && stack[at - 1].depth < entry.depth; --at) stack[at] = stack[at - 1];
    stack[at] = entry;
  }
  return size;
}

/// Every level leaves all but one child on the stack.
inline constexpr std::size_t kWideStack = std::size_t{kMaxBvhDepth + 1} * kBvhWidth;

/// Calls visit(leaf) for the leaves met, near ones first.
template <class Counter, class Visit>
void walk_bvh(std::span<const WideBvhNode> nodes, const TileFrustum& frustum,
              const BlockTester<Counter>& tester, const Visit& visit) {
  if (nodes.empty()) return;
  Waiting stack[kWideStack];
  alignas(64) float depth[kBvhWidth];
  std::size_t size = 0;
  const auto open = [&](const WideBvhNode& node) {
    tester.counter().nodes(node.count);
    const std::uint32_t met = frustum.meet(node, tester.image().farthest(), depth);
    size = push_nearest_last(node, met, depth, stack, size);
  };
  open(nodes[0]);
  while (size > 0) {
    const Waiting next = stack[--size];
    if (next.depth > tester.image().farthest()) continue;
    if (next.child.is_leaf()) {
      visit(next.child.index());
    } else {
      open(nodes[next.child.index()]);
    }
  }
}

/// Sees each triangle of a tile once, however many leaves hold it (mailboxing).
class Mailbox {
 public:
  Mailbox(std::vector<std::uint32_t>& stamps, std::uint32_t serial)
      : stamps_(stamps.data()), serial_(serial) {}
  bool is_new(std::uint32_t item) {
    if (stamps_[item] == serial_) return false;
    stamps_[item] = serial_;
    return true;
  }

 private:
  std::uint32_t* stamps_;
  std::uint32_t serial_;
};

template <class Counter>
void brute_force(const TriangleSoup& soup, BlockTester<Counter>& tester, TileScratch& scratch) {
  TriangleBatch<Counter> batch(tester, soup.triangles, scratch.block);
  for (std::uint32_t i = 0; i < soup.triangle_count; ++i) batch.push(i);
  batch.flush();
}

template <class Counter>
void kd(const TileRays& tile, const KdView& tree, const TriangleSoup& soup,
        BlockTester<Counter>& tester, TileScratch& scratch) {
  scratch.begin_tile(soup.triangle_count, 0);
  Mailbox triangles(scratch.triangle_stamps, scratch.serial);
  TriangleBatch<Counter> batch(tester, soup.triangles, scratch.block);
  walk_kd(tree.tree, TileFrustum(tree.forms, tile), tester, [&](std::uint32_t triangle) {
    if (triangles.is_new(triangle)) batch.push(triangle);
  });
  batch.flush();
}

template <class Counter>
void two_level_kd(const TileRays& tile, const TopLevelKdView& top, const TriangleSoup& soup,
                  BlockTester<Counter>& tester, TileScratch& scratch) {
  scratch.begin_tile(soup.triangle_count, top.clusters.size());
  Mailbox seen_triangles(scratch.triangle_stamps, scratch.serial);
  Mailbox seen_clusters(scratch.cluster_stamps, scratch.serial);
  TriangleBatch<Counter> batch(tester, soup.triangles, scratch.block);
  const auto enter = [&](std::uint32_t c) {
    if (!seen_clusters.is_new(c)) return;
    const KdView& cluster = top.clusters[c];
    const TileFrustum local(cluster.forms, tile);
    if (local.misses(local.cell_of(cluster.tree.bounds, 0), tester.image().farthest())) return;
    tester.counter().clusters(1);
    top.mesh.require(c);
    walk_kd(cluster.tree, local, tester, [&](std::uint32_t triangle) {
      if (seen_triangles.is_new(triangle)) batch.push(triangle);
    });
  };
  walk_kd(top.tree.tree, TileFrustum(top.tree.forms, tile), tester, enter);
  batch.flush();
}

template <class Counter>
void test_leaf(const BlockSoup& soup, std::uint32_t number, BlockTester<Counter>& tester,
               TileScratch& scratch) {
  const TriangleBlock& block = soup.blocks[number];
  if (soup.cache != nullptr) {
    tester.test(block, number, *soup.cache, scratch.block);
  } else {
    tester.test(block, scratch.block);
  }
}

template <class Counter>
void bvh(const TileRays& tile, const BvhView& tree, const BlockSoup& soup,
         BlockTester<Counter>& tester, TileScratch& scratch) {
  walk_bvh(tree.nodes, TileFrustum(tree.forms, tile), tester,
           [&](std::uint32_t leaf) { test_leaf(soup, tree.first_leaf + leaf, tester, scratch); });
}

template <class Counter>
void two_level_bvh(const TileRays& tile, const TopLevelView& top, const BlockSoup& soup,
                   BlockTester<Counter>& tester, TileScratch& scratch) {
  walk_bvh(top.tree.nodes, TileFrustum(top.tree.forms, tile), tester, [&](std::uint32_t leaf) {
    tester.counter().clusters(1);
    const std::uint32_t c = top.cluster_of_leaf[leaf];
    top.mesh.require(c);
    bvh(tile, top.clusters[c], soup, tester, scratch);
  });
}

/// Traces with counting or without, then stores what was hit, if anything.
template <class Walk>
bool with_tester(const TileRays& tile, const Vec3f* positions, TileHits& hits,
                 TraceCounters* counters, const Walk& walk) {
  const auto run = [&](auto counter) {
    BlockTester<decltype(counter)> tester(tile, positions, counter);
    walk(tester);
    if (tester.image().empty()) return false;
    tester.image().store(hits);
    return true;
  };
  return counters != nullptr ? run(Counting{*counters}) : run(NoCounting{});
}

bool BruteForce(const TileRays& tile, const TriangleSoup& soup, TileHits& hits,
                TileScratch& scratch, TraceCounters* counters) {
  return with_tester(tile, soup.positions, hits, counters,
                     [&](auto& tester) { brute_force(soup, tester, scratch); });
}
bool Kd(const TileRays& tile, const KdView& tree, const TriangleSoup& soup, TileHits& hits,
        TileScratch& scratch, TraceCounters* counters) {
  return with_tester(tile, soup.positions, hits, counters,
                     [&](auto& tester) { kd(tile, tree, soup, tester, scratch); });
}
bool TwoLevelKd(const TileRays& tile, const TopLevelKdView& top, const TriangleSoup& soup,
                TileHits& hits, TileScratch& scratch, TraceCounters* counters) {
  return with_tester(tile, soup.positions, hits, counters,
                     [&](auto& tester) { two_level_kd(tile, top, soup, tester, scratch); });
}
bool OneLevelBvh(const TileRays& tile, const BvhView& tree, const BlockSoup& soup, TileHits& hits,
                 TileScratch& scratch, TraceCounters* counters) {
  return with_tester(tile, soup.positions, hits, counters,
                     [&](auto& tester) { bvh(tile, tree, soup, tester, scratch); });
}
bool TwoLevelBvh(const TileRays& tile, const TopLevelView& top, const BlockSoup& soup,
                 TileHits& hits, TileScratch& scratch, TraceCounters* counters) {
  return with_tester(tile, soup.positions, hits, counters,
                     [&](auto& tester) { two_level_bvh(tile, top, soup, tester, scratch); });
}

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(BruteForce);
HWY_EXPORT(Kd);
HWY_EXPORT(TwoLevelKd);
HWY_EXPORT(OneLevelBvh);
HWY_EXPORT(TwoLevelBvh);

bool trace_tile_brute_force(const TileRays& tile, const TriangleSoup& soup, TileHits& hits,
                            TileScratch& scratch, TraceCounters* counters) {
  return HWY_DYNAMIC_DISPATCH(BruteForce)(tile, soup, hits, scratch, counters);
}
bool trace_tile_kd(const TileRays& tile, const KdView& tree, const TriangleSoup& soup,
                   TileHits& hits, TileScratch& scratch, TraceCounters* counters) {
  return HWY_DYNAMIC_DISPATCH(Kd)(tile, tree, soup, hits, scratch, counters);
}
bool trace_tile_two_level_kd(const TileRays& tile, const TopLevelKdView& top,
                             const TriangleSoup& soup, TileHits& hits, TileScratch& scratch,
                             TraceCounters* counters) {
  return HWY_DYNAMIC_DISPATCH(TwoLevelKd)(tile, top, soup, hits, scratch, counters);
}
bool trace_tile_bvh(const TileRays& tile, const BvhView& tree, const BlockSoup& soup,
                    TileHits& hits, TileScratch& scratch, TraceCounters* counters) {
  return HWY_DYNAMIC_DISPATCH(OneLevelBvh)(tile, tree, soup, hits, scratch, counters);
}
bool trace_tile_two_level_bvh(const TileRays& tile, const TopLevelView& top, const BlockSoup& soup,
                              TileHits& hits, TileScratch& scratch, TraceCounters* counters) {
  return HWY_DYNAMIC_DISPATCH(TwoLevelBvh)(tile, top, soup, hits, scratch, counters);
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
