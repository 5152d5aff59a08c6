// What a tile carries down a structure: its frustum, which culls boxes, and the depth of its
// farthest hit.
#include "common/trace/kernels/tile_image-inl.h"
#include "common/trace/kernels/walk-inl.h"

#if defined(MDK_TILE_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_TILE_WALK_INL_H_
#undef MDK_TILE_WALK_INL_H_
#else
#define MDK_TILE_WALK_INL_H_
#endif

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

/// The outer edges of the pixels of a tile, or of a part of it.
struct TileEdges {
  float left, right, upper, lower;
};

inline TileEdges edges_of(const TileRays& tile) {
  const float x = static_cast<float>(tile.x), y = static_cast<float>(tile.y);
  constexpr float kSide = kTileSide;
  return {x, x + kSide, y, y + kSide};
}

/// Of the triangles in `behind`, those with all corners on the outer side of one of the tile's
/// four planes: where a triangle reaches behind the eye, this stands for its bounds.
template <class CornerSource>
std::uint32_t missed_by_sides(const TileEdges& tile, const CornerSource& corners,
                              std::uint32_t behind) {
  const FloatTag d;
  std::uint32_t missed = 0;
  for (std::size_t i = 0; i < kBlockTriangles; i += hn::Lanes(d)) {
    const Corners p = corners(i);
    const auto one_side = [&](FloatVec a, FloatVec b, FloatVec c, float first, float last) {
      const auto offset = [&](FloatVec coordinate, FloatVec depth, float edge) {
        return hn::Sub(coordinate, hn::Mul(depth, hn::Set(d, edge)));
      };
      const auto below = hn::Max(hn::Max(offset(a, p.a.z, first), offset(b, p.b.z, first)),
                                 offset(c, p.c.z, first));
      const auto above =
          hn::Min(hn::Min(offset(a, p.a.z, last), offset(b, p.b.z, last)), offset(c, p.c.z, last));
      return hn::Or(hn::Lt(below, hn::Zero(d)), hn::Gt(above, hn::Zero(d)));
    };
    missed |= mask_bits(d, hn::Or(one_side(p.a.x, p.b.x, p.c.x, tile.left, tile.right),
                                  one_side(p.a.y, p.b.y, p.c.y, tile.upper, tile.lower)))
              << i;
  }
  return missed & behind;
}

/// A tile's frustum on its way down one tree (walk-inl.h): the four sides as forms, and the depth
/// over boxes, which is least at the corner the depth's gradient picks. Of `tester`: edges() of
/// what is traced, farthest() hit of it so far, and a counter().
template <class Tester>
class TileInTree {
 public:
  struct Cell : BoxForms<kSides>::Cell {
    float nearest[3];  ///< what each axis adds to the least depth
  };

  TileInTree(const FrustumForms& forms, const Tester& tester) : forms_(forms), tester_(tester) {
    const hn::CappedTag<float, 4 * kSides> d;
    const auto [l, r, u, v] = tester.edges();
    alignas(64) const float place[4 * kSides] = {l, r, u, v, l, r, u, v, l, r, u, v, l, r, u, v};
    for (std::size_t i = 0; i < 4 * kSides; i += hn::Lanes(d))
      hn::Store(hn::MulAdd(hn::Load(d, forms.step + i), hn::Load(d, place + i),
                           hn::Load(d, forms.base + i)),
                d, sides_.row(0) + i);
    sides_.choose_corners();
    for (std::size_t axis = 0; axis < 3; ++axis)
      near_plane_[axis] = static_cast<std::uint8_t>(2 * axis + (forms.depth[axis] < 0));
  }

  /// Not those outside, nor those farther than all hits; `depth` gets each child's least depth.
  template <std::uint32_t kWidth>
  HWY_INLINE std::uint32_t enter(const WideNode<kWidth>& node, float (&depth)[kWidth]) const {
    tester_.counter().nodes(node.count);
    return enter(node.bounds, depth) & ((1u << node.count) - 1);
  }
  /// The same for boxes side by side; the last ones must hold numbers, too.
  template <std::size_t kWidth>
  HWY_INLINE std::uint32_t enter(const float (&bounds)[6][kWidth], float (&depth)[kWidth]) const {
    const hn::CappedTag<float, kWidth> d;
    const float farthest = tester_.farthest();
    std::uint32_t entered = 0;
    for (std::size_t i = 0; i < kWidth; i += hn::Lanes(d)) {
      const auto plane = [&](std::size_t r) { return hn::Load(d, bounds[r] + i); };
      const auto largest = [&](std::size_t k) { return sides_.largest(d, bounds, i, k); };
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
    return entered;
  }
  HWY_INLINE bool is_past(float depth) const { return depth > tester_.farthest(); }

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
    if (depth + forms_.depth_offset > tester_.farthest()) return true;
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
  const Tester& tester_;
  BoxForms<kSides> sides_;
  std::uint8_t near_plane_[3];
};

}  // namespace tiles
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
