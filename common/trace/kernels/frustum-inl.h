// A tile's frustum, tested against one box or against all children of a node at once. Compiled once
// per instruction set: no include guard in the usual sense, see tile_kernels.cpp.
//
// A side f(p) = n.p + w is negative where the frustum is not. Its largest value over a box stands
// at one corner, which n's signs pick once per tile:
//
//      lo.y +-------+ n            far corner of a box: per axis hi where n >= 0, else lo;
//           |       |  \           n_x far.x + n_y far.y + n_z far.z + w < 0: box outside.
//           +-------+   side       A node's boxes stand side by side: a vector tests all.
//
// The depth over a box is least at the corner the depth's gradient picks in the same way.
#include <limits>

#include "common/trace/kernels/tile_kernels.h"

#if defined(MDK_FRUSTUM_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_FRUSTUM_INL_H_
#undef MDK_FRUSTUM_INL_H_
#else
#define MDK_FRUSTUM_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

class TileFrustum {
 public:
  TileFrustum(const FrustumForms& forms, const TileRays& tile) : forms_(forms) {
    const hn::CappedTag<float, 4 * kSides> d;
    const float x = static_cast<float>(tile.x), y = static_cast<float>(tile.y);
    constexpr float kSide = kTileSide;
    alignas(64)
        const float place[4 * kSides] = {x, x + kSide, y, y + kSide, x, x + kSide, y, y + kSide,
                                         x, x + kSide, y, y + kSide, x, x + kSide, y, y + kSide};
    for (std::size_t i = 0; i < 4 * kSides; i += hn::Lanes(d))
      hn::Store(hn::MulAdd(hn::Load(d, forms.step + i), hn::Load(d, place + i),
                           hn::Load(d, forms.base + i)),
                d, side_ + i);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < kSides; ++k)
        far_row_[axis][k] = static_cast<std::uint8_t>(2 * axis + (side_[axis * kSides + k] >= 0));
      near_row_[axis] = static_cast<std::uint8_t>(2 * axis + (forms.depth[axis] < 0));
    }
  }

  /// Bit c is set unless child c is outside, or farther than `farthest` as a whole; false bits are
  /// certain, set ones are not. `depth` gets each child's least depth.
  HWY_INLINE std::uint32_t meet(const WideBvhNode& node, float farthest,
                                float (&depth)[kBvhWidth]) const {
    const hn::CappedTag<float, kBvhWidth> d;
    std::uint32_t met = 0;
    for (std::size_t i = 0; i < kBvhWidth; i += hn::Lanes(d)) {
      const auto row = [&](std::size_t r) { return hn::Load(d, node.bounds[r] + i); };
      const auto largest = [&](std::size_t k) {
        const auto z = hn::MulAdd(hn::Set(d, side_[2 * kSides + k]), row(far_row_[2][k]),
                                  hn::Set(d, side_[3 * kSides + k]));
        const auto yz = hn::MulAdd(hn::Set(d, side_[kSides + k]), row(far_row_[1][k]), z);
        return hn::MulAdd(hn::Set(d, side_[k]), row(far_row_[0][k]), yz);
      };
      const auto least = hn::Min(hn::Min(largest(0), largest(1)), hn::Min(largest(2), largest(3)));
      const auto least_depth =
          depth_at(d, row(near_row_[0]), row(near_row_[1]), row(near_row_[2]), forms_.depth_offset);
      hn::Store(least_depth, d, depth + i);
      auto outside = hn::Or(hn::Lt(least, hn::Zero(d)), hn::Gt(least_depth, hn::Set(d, farthest)));
      if (!forms_.in_front) {
        const auto deepest = depth_at(d, row(near_row_[0] ^ 1u), row(near_row_[1] ^ 1u),
                                      row(near_row_[2] ^ 1u), forms_.front_offset);
        outside = hn::Or(outside, hn::Lt(deepest, hn::Zero(d)));
      }
      alignas(8) std::uint8_t bits[8] = {};
      hn::StoreMaskBits(d, hn::Not(outside), bits);
      met |= (bits[0] & ((1u << hn::Lanes(d)) - 1)) << i;
    }
    return met & ((1u << node.count) - 1);
  }

  /// A kd-tree's cell and what each axis adds to the forms over it: a child differs in one axis.
  struct Cell {
    std::uint32_t node;
    float lo[3], hi[3];
    float nearest[3];                      ///< of the least depth
    alignas(16) float largest[3][kSides];  ///< of the sides' largest values
  };

  HWY_INLINE void set_axis(Cell& cell, std::size_t axis, float lo, float hi) const {
    const hn::CappedTag<float, kSides> d;
    cell.lo[axis] = lo;
    cell.hi[axis] = hi;
    cell.nearest[axis] = forms_.depth[axis] * (forms_.depth[axis] < 0 ? hi : lo);
    for (std::size_t k = 0; k < kSides; k += hn::Lanes(d)) {
      const auto n = hn::Load(d, side_ + axis * kSides + k);
      hn::Store(hn::Max(hn::Mul(n, hn::Set(d, lo)), hn::Mul(n, hn::Set(d, hi))), d,
                cell.largest[axis] + k);
    }
  }

  Cell cell_of(const Aabb& box, std::uint32_t node) const {
    Cell cell;
    cell.node = node;
    for (std::size_t axis = 0; axis < 3; ++axis) set_axis(cell, axis, box.lo[axis], box.hi[axis]);
    return cell;
  }

  /// Whether the cell is outside or farther than `farthest`; false where in doubt.
  HWY_INLINE bool misses(const Cell& cell, float farthest) const {
    const hn::CappedTag<float, kSides> d;
    for (std::size_t k = 0; k < kSides; k += hn::Lanes(d)) {
      const auto xy = hn::Add(hn::Load(d, cell.largest[0] + k), hn::Load(d, cell.largest[1] + k));
      const auto zw =
          hn::Add(hn::Load(d, cell.largest[2] + k), hn::Load(d, side_ + 3 * kSides + k));
      if (!hn::AllFalse(d, hn::Lt(hn::Add(xy, zw), hn::Zero(d)))) return true;
    }
    const float depth = cell.nearest[0] + cell.nearest[1] + cell.nearest[2];
    if (depth + forms_.depth_offset > farthest) return true;
    if (forms_.in_front) return false;
    float deepest = forms_.front_offset;
    for (std::size_t axis = 0; axis < 3; ++axis)
      deepest += forms_.depth[axis] * (forms_.depth[axis] < 0 ? cell.lo[axis] : cell.hi[axis]);
    return deepest < 0;
  }

  /// Whether rays of the tile meet the cell below a split plane before the one above it.
  bool below_first(std::uint32_t axis, float split) const { return forms_.eye[axis] <= split; }

 private:
  template <class D, class V>
  HWY_INLINE V depth_at(D d, V x, V y, V z, float offset) const {
    const Vec3f& n = forms_.depth;
    return hn::MulAdd(
        hn::Set(d, n.x), x,
        hn::MulAdd(hn::Set(d, n.y), y, hn::MulAdd(hn::Set(d, n.z), z, hn::Set(d, offset))));
  }

  const FrustumForms& forms_;
  alignas(64) float side_[4 * kSides];
  std::uint8_t far_row_[3][kSides];
  std::uint8_t near_row_[3];
};

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
