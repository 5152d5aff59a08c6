// What a beam carries down a structure: the bounds of the rays that are left, as seen along the
// beam, which cull boxes. What leaves hold is tested sixteen triangles by sixteen rays.
#include "common/trace/kernels/beam_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/beam_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/beam_test-inl.h"
#include "common/trace/kernels/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace beams {

/// The bounds of a beam as linear forms over one basis: a box is entered only if every form is at
/// least 0 somewhere in it. Forms come in pairs, low side and high side of u, v and w; the high
/// side of w is at least 0 everywhere and orders boxes by where they begin.
class BeamInTree {
 public:
  static constexpr std::size_t kForms = 8;  ///< three pairs, and two that say nothing
  using Cell = BoxForms<kForms>::Cell;

  template <class Tree>
  BeamInTree(const BeamBasis& basis, const TreeLevel<Tree>& level, const BeamRays& rays)
      : BeamInTree(basis, level.local_from_world, level.space, rays) {}

  HWY_INLINE std::uint32_t enter(const WideBvhNode& node, float (&order)[kBvhWidth]) {
    follow();
    const hn::CappedTag<float, kBvhWidth> d;
    std::uint32_t entered = 0;
    for (std::size_t i = 0; i < kBvhWidth; i += hn::Lanes(d)) {
      const auto largest = [&](std::size_t k) { return forms_.largest(d, node.bounds, i, k); };
      const auto u = hn::Min(largest(0), largest(1)), v = hn::Min(largest(2), largest(3));
      const auto inside = hn::Ge(hn::Min(hn::Min(u, v), largest(4)), hn::Zero(d));
      hn::Store(hn::Neg(largest(5)), d, order + i);
      entered |= mask_bits(d, inside) << i;
    }
    return entered & ((1u << node.count) - 1u);
  }
  static constexpr bool is_past(float) { return false; }

  HWY_INLINE void set_axis(Cell& cell, std::size_t axis, float lo, float hi) const {
    forms_.set_axis(cell, axis, lo, hi);
  }
  HWY_INLINE bool misses(const Cell& cell) {
    follow();
    return forms_.is_outside(cell);
  }
  /// Where w grows along the axis.
  bool below_first(std::uint32_t axis, float) const { return forms_.row(axis)[4] > 0; }

  bool finished() const { return rays_.all_occluded(); }

 private:
  BeamInTree(const BeamBasis& basis, const Affine3d& local_from_world, const BeamSpace& space,
             const BeamRays& rays)
      : rays_(rays) {
    const Vec3d origin = local_from_world.point(to_double(basis.origin));
    Vec3d n[3];
    double largest = space.det;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d a = to_double(basis.axis[k]);
      n[k] = space.cofactor[0] * a.x + space.cofactor[1] * a.y + space.cofactor[2] * a.z;
      largest = std::max({largest, std::abs(n[k].x), std::abs(n[k].y), std::abs(n[k].z)});
    }
    const bool usable = std::isfinite(1 / largest) && std::isfinite(largest);
    const double scale = usable ? 1 / largest : 0.0;
    scale_ = usable ? space.det * scale : 0.0;
    for (std::size_t k = 0; k < 3; ++k) set_pair(k, n[k] * scale, origin);
    forms_.choose_corners();
    set_slack(basis, space, scale, origin);
    tighten();
  }

  void set_pair(std::size_t k, const Vec3d& n, const Vec3d& origin) {
    const Vec3f low = to_float(n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      forms_.row(axis)[2 * k] = low[axis];
      forms_.row(axis)[2 * k + 1] = -low[axis];
    }
    offset_[k] = -dot(n, origin);
    size_[k] = {std::abs(n.x), std::abs(n.y), std::abs(n.z)};
  }

  /// What roundings may come to: of the forms over boxes (four of 2^-24, counted as 32), of the
  /// cofactors, and of the corners as the triangle test projects them (six, counted as 16).
  void set_slack(const BeamBasis& basis, const BeamSpace& space, double scale,
                 const Vec3d& origin) {
    const Vec3d reach =
        space.reach + Vec3d{std::abs(origin.x), std::abs(origin.y), std::abs(origin.z)};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f& a = basis.axis[k];
      const double unit = std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
      slack_[k] = 0x1p-19 * dot(size_[k], reach) +
                  space.rounding * scale * unit * 3 * (reach.x + reach.y + reach.z) +
                  scale_ * unit * 0x1p-20 * space.world_reach;
    }
    forms_.row(3)[5] = static_cast<float>(1.01 * dot(size_[2], reach));
  }

  /// Keeps up with the rays that are left.
  HWY_INLINE void follow() {
    if (version_ != rays_.version()) tighten();
  }
  void tighten() {
    version_ = rays_.version();
    const BeamBounds& b = rays_.bounds();
    float* const w = forms_.row(3);
    const float low[3] = {b.u0, b.v0, b.w}, high[2] = {b.u1, b.v1};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto constant = [&](double c) {
        return static_cast<float>(c + slack_[k] + 0x1p-22 * std::abs(c));
      };
      w[2 * k] = constant(offset_[k] - scale_ * static_cast<double>(low[k]));
      if (k < 2) w[2 * k + 1] = constant(scale_ * static_cast<double>(high[k]) - offset_[k]);
    }
  }

  const BeamRays& rays_;
  std::uint32_t version_ = 0;
  double scale_ = 0;  ///< from the beam's coordinates to the forms' values
  double offset_[3], slack_[3];
  Vec3d size_[3];
  BoxForms<kForms> forms_{};
};

/// What a beam needs at hand.
struct BeamTrace {
  const TraceScene& scene;
  const BeamBasis& basis;
  BeamRays& rays;
  TileScratch& scratch;

  /// Whether there is anything to enter, and any ray that could.
  template <class Tree>
  bool may_enter(const TreeLevel<Tree>& level) const {
    return !level.tree.nodes.empty() && !rays.all_occluded();
  }
  template <class Tree>
  BeamInTree rays_in(const TreeLevel<Tree>& level) const {
    return BeamInTree(basis, level, rays);
  }
  void test(const TriangleBlock& block, PosedBlock& posed) const {
    pose_block(block, scene.positions, posed);
    rays.test(posed, block.count);
  }
};

void occlude(const BeamTrace& t, std::monostate) {
  PosedBlock posed;
  const auto test = [&](const TriangleBlock& block) { t.test(block, posed); };
  TriangleBatch batch(t.scene.triangles, test);
  for (std::uint32_t i = 0; i < t.scene.triangle_count; ++i) batch.push(i);
  batch.flush();
}

void occlude(const BeamTrace& t, const BvhLevels& levels) {
  PosedBlock spare;
  const auto test_leaf = [&](std::uint32_t number) {
    const TriangleBlock& block = t.scene.blocks[number];
    if (t.scene.posed_blocks == nullptr) return t.test(block, spare);
    const auto pose = [&](PosedBlock& out) { pose_block(block, t.scene.positions, out); };
    t.rays.test(t.scene.posed_blocks->get(number, spare, pose), block.count);
  };
  const auto test_leaves = [&](const TreeLevel<BvhView>& level) {
    if (!t.may_enter(level)) return;
    BeamInTree rays = t.rays_in(level);
    walk_bvh(level.tree.nodes, rays,
             [&](std::uint32_t leaf) { test_leaf(level.tree.first_leaf + leaf); });
  };
  if (levels.clusters.empty()) return test_leaves(levels.top);
  if (!t.may_enter(levels.top)) return;
  BeamInTree rays = t.rays_in(levels.top);
  walk_bvh(levels.top.tree.nodes, rays,
           [&](std::uint32_t leaf) { test_leaves(levels.clusters[levels.cluster_of_leaf[leaf]]); });
}

void occlude(const BeamTrace& t, const KdLevels& levels) {
  t.scratch.begin_tile(t.scene.triangle_count, levels.clusters.size());
  Mailbox seen_triangles(t.scratch.triangle_stamps, t.scratch.serial);
  Mailbox seen_clusters(t.scratch.cluster_stamps, t.scratch.serial);
  PosedBlock posed;
  const auto test = [&](const TriangleBlock& block) { t.test(block, posed); };
  TriangleBatch batch(t.scene.triangles, test);
  const auto test_leaves = [&](const TreeLevel<KdTreeView>& level) {
    if (!t.may_enter(level)) return;
    BeamInTree rays = t.rays_in(level);
    walk_kd(level.tree, rays, [&](std::uint32_t triangle) {
      if (seen_triangles.is_new(triangle)) batch.push(triangle);
    });
    batch.flush();
  };
  if (levels.clusters.empty()) return test_leaves(levels.top);
  if (!t.may_enter(levels.top)) return;
  BeamInTree rays = t.rays_in(levels.top);
  walk_kd(levels.top.tree, rays, [&](std::uint32_t c) {
    if (seen_clusters.is_new(c)) test_leaves(levels.clusters[c]);
  });
}

void OccludeBeam(const TraceScene& scene, RayBeam& beam, TileScratch& scratch) {
  BeamRays rays(beam);
  const BeamTrace trace{scene, beam.basis, rays, scratch};
  if (const auto* bvh = std::get_if<BvhLevels>(&scene.structure)) return occlude(trace, *bvh);
  if (const auto* kd = std::get_if<KdLevels>(&scene.structure)) return occlude(trace, *kd);
  occlude(trace, std::monostate());
}

}  // namespace beams
using beams::OccludeBeam;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(OccludeBeam);

void occlude_beam(const TraceScene& scene, RayBeam& beam, TileScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(OccludeBeam)(scene, beam, scratch);
}

}  // namespace mdk
#endif  // HWY_ONCE
