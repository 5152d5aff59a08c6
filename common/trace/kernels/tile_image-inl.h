// The picture of one tile while it is traced: inverse depth and triangle of every pixel, and
// the one triangle test of the project: every technique, brute force included, ends here, so every
// technique finds the same hits to the bit.
//
// Pixels are kept in 4x4 squares, a vector each, so that a triangle a few pixels wide wastes few
// lanes; 16 squares make a tile, so that one vector tells which squares a triangle may touch:
//
//       +----+----+----+----+
//       | 0  | 1  | 2  | 3  |   square s holds pixels s*16 .. s*16+15, row by row;
//       +----+----+----+----+   far_[s] is the smallest inverse depth in it: what is farther
//       | 4  | 5  | ...         is hidden there.
//
// A pixel is hit where the three edge forms have one sign (zero counts as both: shared edges leave
// no gap), within the triangle's pixel bounds; its inverse depth is clamped to those of the
// corners. For triangles of sane shape bounds and clamp change nothing; for slivers, whose forms
// are all rounding, they keep the hit inside what any box around the triangle shows, which is what
// makes structures exact. Multiplications and additions are rounded apart (no fused ones): the same
// hits on every machine.
#include <limits>

#include "common/trace/kernels/projection-inl.h"

#if defined(MDK_TILE_IMAGE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_TILE_IMAGE_INL_H_
#undef MDK_TILE_IMAGE_INL_H_
#else
#define MDK_TILE_IMAGE_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace tiles {

inline constexpr std::uint32_t kSquareSide = 4;
inline constexpr std::uint32_t kSquares = 16;
inline constexpr std::uint32_t kSquarePixels = 16;
static_assert(kSquares * kSquarePixels == kTilePixels && kSquares <= kBlockTriangles);

/// 0 1 2 3 0 1 2 3 ... and 0 0 0 0 1 1 1 1 ...: column and row in a 4x4 grid.
alignas(64) inline constexpr float kGridColumn[16] = {0, 1, 2, 3, 0, 1, 2, 3,
                                                      0, 1, 2, 3, 0, 1, 2, 3};
alignas(64) inline constexpr float kGridRow[16] = {0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};

class TileImage {
 public:
  explicit TileImage(const TileRays& tile)
      : left_(static_cast<float>(tile.x) + 0.5f), top_(static_cast<float>(tile.y) + 0.5f) {}

  /// The smallest inverse depth of the tile's hits; 0 while a ray has none.
  float min_inverse_depth() const { return min_inverse_depth_; }
  /// The depth past which nothing matters any more.
  float farthest() const { return farthest_; }

  /// Which triangles of a projected block, from lane `i`, may be hit in this tile, by their bounds.
  HWY_INLINE FloatMask may_hit(const ProjectedBlock& block, std::size_t i) const {
    const FloatTag d;
    const auto overlaps = [&](const float* first, const float* last, float begin) {
      return hn::And(hn::Le(hn::Load(d, first + i), hn::Set(d, begin + (kTileSide - 1))),
                     hn::Ge(hn::Load(d, last + i), hn::Set(d, begin)));
    };
    const auto in_x = overlaps(block.first_x, block.last_x, left_);
    const auto in_y = overlaps(block.first_y, block.last_y, top_);
    const auto seen =
        hn::Ge(hn::Load(d, block.max_inverse_depth + i), hn::Set(d, min_inverse_depth_));
    return hn::And(hn::And(in_x, in_y), seen);
  }

  /// The closest hits with the triangles in `mask` of a block. Returns how many ray-triangle pairs
  /// were evaluated.
  std::uint32_t test(const std::uint32_t* triangles, const ProjectedBlock& projected,
                     std::uint32_t mask) {
    if (!begun_) begin();
    std::uint32_t pairs = 0;
    const std::uint32_t small = mask & projected.small;
    changed_ = 0;
    if (small != 0) pairs += test_small(triangles, projected, small);
    for (std::uint32_t rest = mask & ~small; rest != 0; rest &= rest - 1)
      pairs += test_large(triangles, projected, static_cast<std::size_t>(__builtin_ctz(rest)));
    if (changed_ != 0) update_far();
    return pairs;
  }

  /// Rows of 16 pixels, depths instead of their inverses.
  void store(TileHits& hits) const {
    const FloatTag d;
    alignas(64) float t[kTilePixels];
    for (std::size_t i = 0; i < kTilePixels; i += hn::Lanes(d))
      hn::Store(hn::Div(hn::Set(d, 1.0f), hn::Load(d, inverse_depth_ + i)), d, t + i);
    const hn::CappedTag<float, kSquareSide> d4;
    const hn::RebindToUnsigned<decltype(d4)> du4;
    for (std::size_t y = 0; y < kTileSide; ++y)
      for (std::size_t column = 0; column < 4; ++column) {
        const std::size_t to = y * kTileSide + column * kSquareSide;
        const std::size_t square = y / kSquareSide * 4 + column;
        const std::size_t from = square * kSquarePixels + y % kSquareSide * kSquareSide;
        for (std::size_t k = 0; k < kSquareSide; k += hn::Lanes(d4)) {
          hn::Store(hn::Load(d4, t + from + k), d4, hits.t + to + k);
          hn::Store(hn::Load(du4, triangle_ + from + k), du4, hits.triangle + to + k);
        }
      }
  }

  bool empty() const { return empty_; }

 protected:
  void begin() {
    const FloatTag d;
    const hn::RebindToUnsigned<FloatTag> du;
    begun_ = true;
    for (std::size_t i = 0; i < kTilePixels; i += hn::Lanes(d)) {
      hn::Store(hn::Zero(d), d, inverse_depth_ + i);
      hn::Store(hn::Set(du, kNoHit), du, triangle_ + i);
    }
    for (std::size_t i = 0; i < kSquares; i += hn::Lanes(d)) hn::Store(hn::Zero(d), d, far_ + i);
    set_places();
  }

  /// To be called where left_ or top_ changed.
  void set_places() {
    const FloatTag d;
    for (std::size_t i = 0; i < kSquares; i += hn::Lanes(d)) {
      for (std::size_t k = 0; k < 4; ++k) {
        const float offset = static_cast<float>(k * kSquareSide);
        hn::Store(hn::Add(hn::Load(d, kGridColumn + i), hn::Set(d, left_ + offset)), d, x_[k] + i);
        hn::Store(hn::Add(hn::Load(d, kGridRow + i), hn::Set(d, top_ + offset)), d, y_[k] + i);
      }
    }
  }

  /// Bit s is set unless the bounds or the depth of triangle `i` keep it out of square s.
  HWY_INLINE std::uint32_t squares_touched(const ProjectedBlock& p, std::size_t i) const {
    const FloatTag d;
    const auto first_x = hn::Set(d, p.first_x[i] - left_ - (kSquareSide - 1));
    const auto last_x = hn::Set(d, p.last_x[i] - left_);
    const auto first_y = hn::Set(d, p.first_y[i] - top_ - (kSquareSide - 1));
    const auto last_y = hn::Set(d, p.last_y[i] - top_);
    const auto inverse_depth = hn::Set(d, p.max_inverse_depth[i]);
    const auto side = hn::Set(d, float{kSquareSide});
    std::uint32_t touched = 0;
    for (std::size_t s = 0; s < kSquares; s += hn::Lanes(d)) {
      const auto x = hn::Mul(hn::Load(d, kGridColumn + s), side);
      const auto y = hn::Mul(hn::Load(d, kGridRow + s), side);
      const auto in_x = hn::And(hn::Ge(x, first_x), hn::Le(x, last_x));
      const auto in_y = hn::And(hn::Ge(y, first_y), hn::Le(y, last_y));
      const auto seen = hn::Ge(inverse_depth, hn::Load(d, far_ + s));
      touched |= mask_bits(d, hn::And(hn::And(in_x, in_y), seen)) << s;
    }
    return touched;
  }

  /// Bit s is set unless some edge has all pixel centres of square s strictly on its outer side,
  /// for both windings. Exact: a form rounds monotonically in X and in Y, so its extremes over a
  /// square are those at its corner pixels, computed just as test_square() does.
  HWY_INLINE std::uint32_t squares_inside_edges(const ProjectedBlock& p, std::size_t i) const {
    const FloatTag d;
    const auto side = hn::Set(d, float{kSquareSide}), reach = hn::Set(d, float{kSquareSide - 1});
    std::uint32_t touched = 0;
    for (std::size_t s = 0; s < kSquares; s += hn::Lanes(d)) {
      const auto x0 = hn::MulAdd(hn::Load(d, kGridColumn + s), side, hn::Set(d, left_));
      const auto y0 = hn::MulAdd(hn::Load(d, kGridRow + s), side, hn::Set(d, top_));
      const auto x1 = hn::Add(x0, reach), y1 = hn::Add(y0, reach);
      auto none_below = hn::Eq(x0, x0), none_above = none_below;
      for (const ImageForms& e : p.edge) {
        const auto x = hn::Set(d, e.x[i]), y = hn::Set(d, e.y[i]), z = hn::Set(d, e.z[i]);
        const auto left = hn::Mul(x, x0), right = hn::Mul(x, x1);
        const auto top = hn::Add(hn::Mul(y, y0), z), bottom = hn::Add(hn::Mul(y, y1), z);
        const auto high = hn::Add(hn::Max(left, right), hn::Max(top, bottom));
        const auto low = hn::Add(hn::Min(left, right), hn::Min(top, bottom));
        none_below = hn::And(none_below, hn::Ge(high, hn::Zero(d)));
        none_above = hn::And(none_above, hn::Le(low, hn::Zero(d)));
      }
      touched |= mask_bits(d, hn::Or(none_below, none_above)) << s;
    }
    return touched;
  }

  /// One triangle against all squares it may touch.
  std::uint32_t test_large(const std::uint32_t* triangles, const ProjectedBlock& p, std::size_t i) {
    // Fewer squares are tested sooner than told apart.
    constexpr int kWorthEdges = 6;
    std::uint32_t squares = squares_touched(p, i);
    if (__builtin_popcount(squares) >= kWorthEdges) squares &= squares_inside_edges(p, i);
    // Behind the eye, too, rays extended backwards are inside all edges.
    const float above = (p.behind >> i & 1u) != 0 ? 0.0f : -std::numeric_limits<float>::infinity();
    const auto pairs = static_cast<std::uint32_t>(__builtin_popcount(squares)) * kSquarePixels;
    for (; squares != 0; squares &= squares - 1)
      test_square({triangles[i], above}, p, i, static_cast<std::uint32_t>(__builtin_ctz(squares)));
    return pairs;
  }

  struct Candidate {
    std::uint32_t triangle;
    float above;  ///< what a hit's inverse depth must exceed before it is clamped
  };

  HWY_INLINE void test_square(const Candidate& candidate, const ProjectedBlock& p, std::size_t i,
                              std::uint32_t square) {
    // No branch before the end: whether a square is hit cannot be predicted.
    const FloatTag d;
    const hn::RebindToUnsigned<FloatTag> du;
    for (std::size_t k = 0; k < kSquarePixels; k += hn::Lanes(d)) {
      const auto x = hn::Load(d, x_[square % 4] + k), y = hn::Load(d, y_[square / 4] + k);
      const auto value = [&](const ImageForms& form) {
        return hn::Add(hn::Mul(hn::Set(d, form.x[i]), x),
                       hn::Add(hn::Mul(hn::Set(d, form.y[i]), y), hn::Set(d, form.z[i])));
      };
      const auto inside = one_sign(value(p.edge[0]), value(p.edge[1]), value(p.edge[2]));
      const auto in_x =
          hn::And(hn::Ge(x, hn::Set(d, p.first_x[i])), hn::Le(x, hn::Set(d, p.last_x[i])));
      const auto in_y =
          hn::And(hn::Ge(y, hn::Set(d, p.first_y[i])), hn::Le(y, hn::Set(d, p.last_y[i])));
      const auto free = value(p.inverse_depth);
      const auto inverse_depth = hn::Max(hn::Min(free, hn::Set(d, p.max_inverse_depth[i])),
                                         hn::Set(d, p.min_inverse_depth[i]));

      float* best = inverse_depth_ + square * kSquarePixels + k;
      std::uint32_t* best_id = triangle_ + square * kSquarePixels + k;
      const auto old = hn::Load(d, best);
      const auto old_id = hn::Load(du, best_id);
      const auto new_id = hn::Set(du, candidate.triangle);
      const auto tie =
          hn::And(hn::Eq(inverse_depth, old), hn::RebindMask(d, hn::Lt(new_id, old_id)));
      const auto closer = hn::Or(hn::Gt(inverse_depth, old), tie);
      const auto hit = hn::And(hn::And(inside, hn::Gt(free, hn::Set(d, candidate.above))),
                               hn::And(closer, hn::And(in_x, in_y)));
      hn::Store(hn::IfThenElse(hit, inverse_depth, old), d, best);
      hn::Store(hn::IfThenElse(hn::RebindMask(du, hit), new_id, old_id), du, best_id);
      changed_ |= static_cast<std::uint32_t>(!hn::AllFalse(d, hit)) << square;
    }
  }

  static HWY_INLINE FloatMask one_sign(FloatVec a, FloatVec b, FloatVec c) {
    const FloatTag d;
    return hn::Or(hn::Ge(hn::Min(hn::Min(a, b), c), hn::Zero(d)),
                  hn::Le(hn::Max(hn::Max(a, b), c), hn::Zero(d)));
  }

  /// Triangles of at most 2x2 pixels, one a lane: each lane has a pixel of its own.
  std::uint32_t test_small(const std::uint32_t* triangles, const ProjectedBlock& p,
                           std::uint32_t mask) {
    const FloatTag d;
    std::uint32_t pairs = 0;
    for (std::size_t i = 0; i < kBlockTriangles; i += hn::Lanes(d)) {
      const std::uint32_t lanes = mask >> i & ((1u << hn::Lanes(d)) - 1);
      if (lanes == 0) continue;
      for (int corner = 0; corner < 4; ++corner)
        pairs += test_pixel_each(
            triangles, p, i, lanes,
            hn::Add(hn::Load(d, p.first_x + i), hn::Set(d, static_cast<float>(corner & 1))),
            hn::Add(hn::Load(d, p.first_y + i), hn::Set(d, static_cast<float>(corner >> 1))));
    }
    return pairs;
  }

  /// Each triangle of `lanes`, from lane `i`, against the pixel (x, y) of its lane, which is not
  /// before its first.
  HWY_INLINE std::uint32_t test_pixel_each(const std::uint32_t* triangles, const ProjectedBlock& p,
                                           std::size_t i, std::uint32_t lanes, FloatVec x,
                                           FloatVec y) {
    const FloatTag d;
    const auto from_left = hn::Sub(x, hn::Set(d, left_));
    const auto from_top = hn::Sub(y, hn::Set(d, top_));
    const auto last = hn::Set(d, float{kTileSide - 1});
    const auto in_bounds =
        hn::And(hn::Le(x, hn::Load(d, p.last_x + i)), hn::Le(y, hn::Load(d, p.last_y + i)));
    const auto in_tile = hn::And(hn::Ge(hn::Min(from_left, from_top), hn::Zero(d)),
                                 hn::Le(hn::Max(from_left, from_top), last));
    lanes &= mask_bits(d, hn::And(in_bounds, in_tile));
    if (lanes == 0) return 0;
    const auto value = [&](const ImageForms& form) {
      return hn::Add(hn::Mul(hn::Load(d, form.x + i), x),
                     hn::Add(hn::Mul(hn::Load(d, form.y + i), y), hn::Load(d, form.z + i)));
    };
    const auto inside = one_sign(value(p.edge[0]), value(p.edge[1]), value(p.edge[2]));
    const auto pairs = static_cast<std::uint32_t>(__builtin_popcount(lanes));
    lanes &= mask_bits(d, inside);
    if (lanes == 0) return pairs;

    alignas(64) float inverse_depth[kBlockTriangles];
    hn::Store(hn::Max(hn::Min(value(p.inverse_depth), hn::Load(d, p.max_inverse_depth + i)),
                      hn::Load(d, p.min_inverse_depth + i)),
              d, inverse_depth);
    const hn::RebindToSigned<FloatTag> di;
    alignas(64) std::int32_t pixel_x[kBlockTriangles], pixel_y[kBlockTriangles];
    hn::Store(hn::ConvertTo(di, from_left), di, pixel_x);
    hn::Store(hn::ConvertTo(di, from_top), di, pixel_y);
    for (; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctz(lanes));
      offer(static_cast<std::uint32_t>(pixel_x[lane]), static_cast<std::uint32_t>(pixel_y[lane]),
            inverse_depth[lane], triangles[i + lane]);
    }
    return pairs;
  }

  /// A hit of one pixel of the tile.
  HWY_INLINE void offer(std::uint32_t x, std::uint32_t y, float inverse_depth, std::uint32_t id) {
    const std::uint32_t square = y / kSquareSide * 4 + x / kSquareSide;
    const std::uint32_t at =
        square * kSquarePixels + y % kSquareSide * kSquareSide + x % kSquareSide;
    if (inverse_depth < inverse_depth_[at] ||
        (inverse_depth == inverse_depth_[at] && id >= triangle_[at]))
      return;
    inverse_depth_[at] = inverse_depth;
    triangle_[at] = id;
    changed_ |= 1u << square;
  }

  void update_far() {
    empty_ = false;
    touched_ |= changed_;
    for (; changed_ != 0; changed_ &= changed_ - 1) {
      const auto square = static_cast<std::size_t>(__builtin_ctz(changed_));
      far_[square] = min_of_sixteen(inverse_depth_ + square * kSquarePixels);
    }
    const float min = min_of_sixteen(far_);
    if (min == min_inverse_depth_) return;
    min_inverse_depth_ = min;
    farthest_ = 1.0f / min;
  }

  float left_, top_;  ///< of the first pixel's centre
  float min_inverse_depth_ = 0;
  float farthest_ = std::numeric_limits<float>::infinity();
  std::uint32_t changed_ = 0;  ///< squares with new hits
  std::uint32_t touched_ = 0;  ///< squares that have had any
  bool begun_ = false;
  bool empty_ = true;
  alignas(64) float x_[4][kSquarePixels];  ///< of the pixel centres of each column of squares
  alignas(64) float y_[4][kSquarePixels];  ///< and of each row
  alignas(64) float far_[kSquares];
  alignas(64) float inverse_depth_[kTilePixels];
  alignas(64) std::uint32_t triangle_[kTilePixels];
};

}  // namespace tiles
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
