// How a tile walks a structure: cells and boxes are tested with the tile's frustum, near ones
// first; triangles met in leaves are collected and tested a vector at a time.
#include "common/trace/kernels/tile_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/tile_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/frustum-inl.h"
#include "common/trace/kernels/triangle_batch-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {

/// Walks a kd-tree (inverse frustum culling, RSH05): the cell shrinks on the way down, and is
/// tested whole. Calls visit(reference) for what stands in the leaves met, near leaves first;
/// `farthest` gives the depth past which nothing matters any more.
template <class Visit, class Farthest>
void walk_kd(const KdTreeView& tree, TileFrustum& frustum, TraceCounters* counters,
             const Farthest& farthest, const Visit& visit) {
  struct Entry {
    std::uint32_t node;
    Vec3f lo, hi;
  };
  if (tree.nodes.empty()) return;
  Entry stack[kMaxKdDepth + 2];
  std::size_t size = 0;
  stack[size++] = {0, tree.bounds.lo, tree.bounds.hi};
  while (size > 0) {
    const Entry cell = stack[--size];
    if (counters != nullptr) ++counters->node_visits;
    frustum.set_farthest(farthest());
    if (frustum.misses(cell.lo, cell.hi)) continue;
    const KdNode node = tree.nodes[cell.node];
    if (node.is_leaf()) {
      for (std::uint32_t i = 0; i < node.ref_count(); ++i) visit(tree.refs[node.first_ref() + i]);
      continue;
    }
    Entry below = cell, above = cell;
    below.node = node.below();
    above.node = node.above();
    below.hi[node.axis()] = node.split();
    above.lo[node.axis()] = node.split();
    const bool below_first = frustum.below_first(node.axis(), node.split());
    stack[size++] = below_first ? above : below;
    stack[size++] = below_first ? below : above;
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

void BruteForce(const TileRays& tile, const TriangleSoup& soup, TileHits& hits, TileScratch&,
                TraceCounters* counters) {
  TriangleBatch batch(tile, soup, hits, counters);
  for (std::uint32_t i = 0; i < soup.triangle_count; ++i) batch.push(i);
  batch.flush();
}

void Kd(const TileRays& tile, const KdTreeView& tree, const TriangleSoup& soup, TileHits& hits,
        TileScratch& scratch, TraceCounters* counters) {
  scratch.begin_tile(soup.triangle_count, 0);
  Mailbox triangles(scratch.triangle_stamps, scratch.serial);
  TriangleBatch batch(tile, soup, hits, counters);
  TileFrustum frustum(tile, *tile.world_basis, tree.bounds);
  walk_kd(
      tree, frustum, counters, [&] { return batch.farthest(); },
      [&](std::uint32_t triangle) {
        if (triangles.is_new(triangle)) batch.push(triangle);
      });
  batch.flush();
}

void TwoLevelKd(const TileRays& tile, const KdTreeView& top, std::span<const ClusterView> clusters,
                const TriangleSoup& soup, TileHits& hits, TileScratch& scratch,
                TraceCounters* counters) {
  scratch.begin_tile(soup.triangle_count, clusters.size());
  Mailbox seen_triangles(scratch.triangle_stamps, scratch.serial);
  Mailbox seen_clusters(scratch.cluster_stamps, scratch.serial);
  TriangleBatch batch(tile, soup, hits, counters);
  const auto farthest = [&] { return batch.farthest(); };
  const auto enter = [&](std::uint32_t c) {
    if (!seen_clusters.is_new(c)) return;
    const ClusterView& cluster = clusters[c];
    TileFrustum local(tile, cluster.basis, cluster.tree.bounds);
    local.set_farthest(batch.farthest());
    if (local.misses(cluster.tree.bounds.lo, cluster.tree.bounds.hi)) return;
    if (counters != nullptr) ++counters->clusters_entered;
    walk_kd(cluster.tree, local, counters, farthest, [&](std::uint32_t triangle) {
      if (seen_triangles.is_new(triangle)) batch.push(triangle);
    });
  };
  TileFrustum frustum(tile, *tile.world_basis, top.bounds);
  walk_kd(top, frustum, counters, farthest, enter);
  batch.flush();
}

void BvhWalk(const TileRays& tile, const Bvh& bvh, const TriangleSoup& soup, TileHits& hits,
             TileScratch&, TraceCounters* counters) {
  if (bvh.nodes.empty()) return;
  TriangleBatch batch(tile, soup, hits, counters);
  TileFrustum frustum(tile, *tile.world_basis, bvh.nodes[0].box());
  std::uint32_t stack[kMaxBvhDepth + 2];
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const BvhNode& node = bvh.nodes[stack[--size]];
    if (counters != nullptr) ++counters->node_visits;
    frustum.set_farthest(batch.farthest());
    if (frustum.misses(node.lo, node.hi)) continue;
    if (node.is_leaf()) {
      for (std::uint32_t i = 0; i < node.count; ++i) batch.push(bvh.refs[node.first + i]);
      continue;
    }
    const BvhNode& a = bvh.nodes[node.first];
    const BvhNode& b = bvh.nodes[node.first + 1];
    const bool a_first = frustum.depth_order(a.lo + a.hi) <= frustum.depth_order(b.lo + b.hi);
    stack[size++] = a_first ? node.first + 1 : node.first;
    stack[size++] = a_first ? node.first : node.first + 1;
  }
  batch.flush();
}

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(BruteForce);
HWY_EXPORT(Kd);
HWY_EXPORT(TwoLevelKd);
HWY_EXPORT(BvhWalk);

void trace_tile_brute_force(const TileRays& tile, const TriangleSoup& soup, TileHits& hits,
                            TileScratch& scratch, TraceCounters* counters) {
  HWY_DYNAMIC_DISPATCH(BruteForce)(tile, soup, hits, scratch, counters);
}
void trace_tile_kd(const TileRays& tile, const KdTreeView& tree, const TriangleSoup& soup,
                   TileHits& hits, TileScratch& scratch, TraceCounters* counters) {
  HWY_DYNAMIC_DISPATCH(Kd)(tile, tree, soup, hits, scratch, counters);
}
void trace_tile_bvh(const TileRays& tile, const Bvh& bvh, const TriangleSoup& soup, TileHits& hits,
                    TileScratch& scratch, TraceCounters* counters) {
  HWY_DYNAMIC_DISPATCH(BvhWalk)(tile, bvh, soup, hits, scratch, counters);
}
void trace_tile_two_level_kd(const TileRays& tile, const KdTreeView& top,
                             std::span<const ClusterView> clusters, const TriangleSoup& soup,
                             TileHits& hits, TileScratch& scratch, TraceCounters* counters) {
  HWY_DYNAMIC_DISPATCH(TwoLevelKd)(tile, top, clusters, soup, hits, scratch, counters);
}

}  // namespace mdk
#endif  // HWY_ONCE
