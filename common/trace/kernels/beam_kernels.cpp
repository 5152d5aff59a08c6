// How a beam walks a structure: boxes are culled by the bounds of the rays that are left, as seen
// along the beam; what leaves hold is tested sixteen triangles by sixteen rays.
#include "common/trace/kernels/beam_kernels.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/beam_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/trace/kernels/beam_test-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {

/// The bounds of a beam as linear forms over one basis: a box is met only if every form is at
/// least 0 somewhere in it. Forms come in pairs, low side and high side of u, v and w; the high
/// side of w is at least 0 everywhere and orders boxes by where they begin.
class BeamForms {
 public:
  BeamForms(const BeamBasis& basis, const BeamSpace& space, const BeamRays& rays) : rays_(rays) {
    const Vec3d origin = space.local_from_world.point(to_double(basis.origin));
    Vec3d n[3];
    double largest = space.det;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d a = to_double(basis.axis[k]);
      n[k] = space.cofactor[0] * a.x + space.cofactor[1] * a.y + space.cofactor[2] * a.z;
      largest = std::max({largest, std::abs(n[k].x), std::abs(n[k].y), std::abs(n[k].z)});
    }
    const double scale = 1 / largest;
    const bool usable = std::isfinite(scale) && std::isfinite(largest);
    scale_ = usable ? space.det * scale : 0.0;
    for (std::size_t k = 0; k < 3; ++k) set_pair(k, n[k] * (usable ? scale : 0.0), origin);
    set_slack(basis, space, usable ? scale : 0.0, origin);
    tighten();
  }

  /// Follows the rays that are left.
  HWY_INLINE void follow() {
    if (version_ != rays_.version()) tighten();
  }

  /// Bit c is set unless child c is certainly missed. `order` rises with where children begin.
  HWY_INLINE std::uint32_t meet(const WideBvhNode& node, float (&order)[kBvhWidth]) const {
    const hn::CappedTag<float, kBvhWidth> d;
    std::uint32_t met = 0;
    for (std::size_t i = 0; i < kBvhWidth; i += hn::Lanes(d)) {
      const auto largest = [&](std::size_t k) {
        const auto row = [&](std::size_t axis) {
          return hn::Load(d, node.bounds[far_row_[axis][k]] + i);
        };
        const auto z = hn::MulAdd(hn::Set(d, z_[k]), row(2), hn::Set(d, c_[k]));
        return hn::MulAdd(hn::Set(d, x_[k]), row(0), hn::MulAdd(hn::Set(d, y_[k]), row(1), z));
      };
      const auto u = hn::Min(largest(0), largest(1)), v = hn::Min(largest(2), largest(3));
      const auto inside = hn::Ge(hn::Min(hn::Min(u, v), largest(4)), hn::Zero(d));
      hn::Store(hn::Neg(largest(5)), d, order + i);
      alignas(8) std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, inside, bits);
      met |= (bits[0] & ((1u << hn::Lanes(d)) - 1u)) << i;
    }
    return met & ((1u << node.count) - 1u);
  }

  /// Whether the box is certainly missed.
  HWY_INLINE bool misses(const Aabb& box) const {
    const hn::CappedTag<float, kForms> d;
    for (std::size_t k = 0; k < kForms; k += hn::Lanes(d)) {
      const auto part = [&](const float* n, float lo, float hi) {
        return hn::Max(hn::Mul(hn::Load(d, n + k), hn::Set(d, lo)),
                       hn::Mul(hn::Load(d, n + k), hn::Set(d, hi)));
      };
      const auto xy = hn::Add(part(x_, box.lo.x, box.hi.x), part(y_, box.lo.y, box.hi.y));
      const auto zc = hn::Add(part(z_, box.lo.z, box.hi.z), hn::Load(d, c_ + k));
      if (!hn::AllFalse(d, hn::Lt(hn::Add(xy, zc), hn::Zero(d)))) return true;
    }
    return false;
  }

  /// Whether w grows along an axis of this basis.
  bool rises_along(std::size_t axis) const { return (axis == 0 ? x_ : axis == 1 ? y_ : z_)[4] > 0; }

 private:
  static constexpr std::size_t kForms = 8;  ///< three pairs, and two that say nothing

  void set_pair(std::size_t k, const Vec3d& n, const Vec3d& origin) {
    const Vec3f low = to_float(n);
    for (std::size_t side = 0; side < 2; ++side) {
      const std::size_t i = 2 * k + side;
      x_[i] = side == 0 ? low.x : -low.x;
      y_[i] = side == 0 ? low.y : -low.y;
      z_[i] = side == 0 ? low.z : -low.z;
      far_row_[0][i] = static_cast<std::uint8_t>(0 + (x_[i] > 0));
      far_row_[1][i] = static_cast<std::uint8_t>(2 + (y_[i] > 0));
      far_row_[2][i] = static_cast<std::uint8_t>(4 + (z_[i] > 0));
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
    c_[5] = static_cast<float>(1.01 * dot(size_[2], reach));
  }

  void tighten() {
    version_ = rays_.version();
    const BeamBounds& b = rays_.bounds();
    const float low[3] = {b.u0, b.v0, b.w}, high[2] = {b.u1, b.v1};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto constant = [&](double c) {
        return static_cast<float>(c + slack_[k] + 0x1p-22 * std::abs(c));
      };
      c_[2 * k] = constant(offset_[k] - scale_ * static_cast<double>(low[k]));
      if (k < 2) c_[2 * k + 1] = constant(scale_ * static_cast<double>(high[k]) - offset_[k]);
    }
  }

  const BeamRays& rays_;
  std::uint32_t version_ = 0;
  double scale_ = 0;  ///< from the beam's coordinates to the forms' values
  double offset_[3], slack_[3];
  Vec3d size_[3];
  alignas(32) float x_[kForms] = {};
  alignas(32) float y_[kForms] = {};
  alignas(32) float z_[kForms] = {};
  alignas(32) float c_[kForms] = {};
  std::uint8_t far_row_[3][kForms] = {};
};

/// A child that waits to be visited.
struct WaitingChild {
  float order;
  WideBvhChild child;
};

/// Calls visit(leaf) for the leaves met, those that begin first first, until no ray is left.
template <class Visit>
void walk_beam_bvh(const BeamBvh& tree, const BeamBasis& basis, const BeamRays& rays,
                   const Visit& visit) {
  if (tree.nodes.empty() || rays.all_occluded()) return;
  BeamForms forms(basis, *tree.space, rays);
  WaitingChild stack[std::size_t{kMaxBvhDepth + 1} * kBvhWidth];
  std::size_t size = 0;
  const auto open = [&](const WideBvhNode& node) {
    forms.follow();
    alignas(64) float order[kBvhWidth];
    const std::size_t bottom = size;
    for (std::uint32_t met = forms.meet(node, order); met != 0; met &= met - 1) {
      const auto c = static_cast<std::size_t>(__builtin_ctz(met));
      std::size_t at = size++;
      for (; at > bottom && stack[at - 1].order < order[c]; --at) stack[at] = stack[at - 1];
      stack[at] = {order[c], node.child[c]};
    }
  };
  open(tree.nodes[0]);
  while (size > 0) {
    const WideBvhChild child = stack[--size].child;
    if (!child.is_leaf()) {
      open(tree.nodes[child.index()]);
      continue;
    }
    visit(child.index());
    if (rays.all_occluded()) return;
  }
}

void beam_bvh(const BeamBvh& tree, const BeamBlocks& blocks, const BeamBasis& basis,
              BeamRays& rays) {
  PosedBlock spare;
  walk_beam_bvh(tree, basis, rays, [&](std::uint32_t leaf) {
    const std::uint32_t number = tree.first_leaf + leaf;
    const TriangleBlock& block = blocks.blocks[number];
    const auto pose = [&](PosedBlock& out) { pose_block(block, blocks.positions, out); };
    if (blocks.cache->usable()) {
      rays.test(blocks.cache->get(number, spare, pose), block.count);
    } else {
      pose(spare);
      rays.test(spare, block.count);
    }
  });
}

/// Calls visit(reference) for what stands in the leaves met, until no ray is left.
template <class Visit>
void walk_beam_kd(const BeamKd& kd, const BeamBasis& basis, const BeamRays& rays,
                  const Visit& visit) {
  if (kd.tree.nodes.empty() || rays.all_occluded()) return;
  BeamForms forms(basis, *kd.space, rays);
  struct Cell {
    std::uint32_t node;
    Aabb box;
  };
  Cell stack[kMaxKdDepth + 2];
  std::size_t size = 0;
  stack[size++] = {0, kd.tree.bounds};
  while (size > 0 && !rays.all_occluded()) {
    Cell& cell = stack[size - 1];
    forms.follow();
    if (forms.misses(cell.box)) {
      --size;
      continue;
    }
    const KdNode node = kd.tree.nodes[cell.node];
    if (node.is_leaf()) {
      --size;
      for (std::uint32_t i = 0; i < node.ref_count(); ++i)
        visit(kd.tree.refs[node.first_ref() + i]);
      continue;
    }
    // The far child takes the cell's place, the near one comes on top of it.
    const std::uint32_t axis = node.axis();
    Cell& next = stack[size++] = cell;
    const bool below_first = forms.rises_along(axis);
    Cell& below = below_first ? next : cell;
    Cell& above = below_first ? cell : next;
    below.node = node.below();
    below.box.hi[axis] = node.split();
    above.node = node.above();
    above.box.lo[axis] = node.split();
  }
}

/// Collects single triangles into blocks.
class BeamBatch {
 public:
  BeamBatch(BeamRays& rays, const TriangleSoup& soup) : rays_(rays), soup_(soup) {}

  void push(std::uint32_t triangle) {
    block_.push(triangle, soup_.triangles[triangle]);
    if (block_.count == kBlockTriangles) flush();
  }
  void flush() {
    if (block_.count == 0) return;
    block_.pad();
    pose_block(block_, soup_.positions, posed_);
    rays_.test(posed_, block_.count);
    block_.count = 0;
  }

 private:
  BeamRays& rays_;
  const TriangleSoup& soup_;
  TriangleBlock block_;
  PosedBlock posed_;
};

/// Whether this beam sees an item for the first time.
bool is_first_visit(std::vector<std::uint32_t>& stamps, std::uint32_t item, std::uint32_t serial) {
  if (stamps[item] == serial) return false;
  stamps[item] = serial;
  return true;
}

void beam_kd(const BeamKd& kd, const TriangleSoup& soup, const BeamBasis& basis, BeamRays& rays,
             TileScratch& scratch) {
  BeamBatch batch(rays, soup);
  walk_beam_kd(kd, basis, rays, [&](std::uint32_t triangle) {
    if (is_first_visit(scratch.triangle_stamps, triangle, scratch.serial)) batch.push(triangle);
  });
  batch.flush();
}

void BeamBruteForce(const TriangleSoup& soup, RayBeam& beam) {
  BeamRays rays(beam);
  BeamBatch batch(rays, soup);
  for (std::uint32_t i = 0; i < soup.triangle_count; ++i) batch.push(i);
  batch.flush();
}

void BeamOneBvh(const BeamBvh& tree, const BeamBlocks& blocks, RayBeam& beam) {
  BeamRays rays(beam);
  beam_bvh(tree, blocks, beam.basis, rays);
}

void BeamTwoLevelBvh(const BeamTopLevel& top, const BeamBlocks& blocks, RayBeam& beam) {
  BeamRays rays(beam);
  walk_beam_bvh(top.tree, beam.basis, rays, [&](std::uint32_t leaf) {
    beam_bvh(top.clusters[top.cluster_of_leaf[leaf]], blocks, beam.basis, rays);
  });
}

void BeamOneKd(const BeamKd& tree, const TriangleSoup& soup, RayBeam& beam, TileScratch& scratch) {
  scratch.begin_tile(soup.triangle_count, 0);
  BeamRays rays(beam);
  beam_kd(tree, soup, beam.basis, rays, scratch);
}

void BeamTwoLevelKd(const BeamKd& top, std::span<const BeamKd> clusters, const TriangleSoup& soup,
                    RayBeam& beam, TileScratch& scratch) {
  scratch.begin_tile(soup.triangle_count, clusters.size());
  BeamRays rays(beam);
  walk_beam_kd(top, beam.basis, rays, [&](std::uint32_t cluster) {
    if (is_first_visit(scratch.cluster_stamps, cluster, scratch.serial))
      beam_kd(clusters[cluster], soup, beam.basis, rays, scratch);
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(BeamBruteForce);
HWY_EXPORT(BeamOneBvh);
HWY_EXPORT(BeamTwoLevelBvh);
HWY_EXPORT(BeamOneKd);
HWY_EXPORT(BeamTwoLevelKd);

void occlude_beam_brute_force(const TriangleSoup& soup, RayBeam& beam) {
  HWY_DYNAMIC_DISPATCH(BeamBruteForce)(soup, beam);
}
void occlude_beam_bvh(const BeamBvh& tree, const BeamBlocks& blocks, RayBeam& beam) {
  HWY_DYNAMIC_DISPATCH(BeamOneBvh)(tree, blocks, beam);
}
void occlude_beam_two_level_bvh(const BeamTopLevel& top, const BeamBlocks& blocks, RayBeam& beam) {
  HWY_DYNAMIC_DISPATCH(BeamTwoLevelBvh)(top, blocks, beam);
}
void occlude_beam_kd(const BeamKd& tree, const TriangleSoup& soup, RayBeam& beam,
                     TileScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(BeamOneKd)(tree, soup, beam, scratch);
}
void occlude_beam_two_level_kd(const BeamKd& top, std::span<const BeamKd> clusters,
                               const TriangleSoup& soup, RayBeam& beam, TileScratch& scratch) {
  HWY_DYNAMIC_DISPATCH(BeamTwoLevelKd)(top, clusters, soup, beam, scratch);
}

}  // namespace mdk
#endif  // HWY_ONCE
