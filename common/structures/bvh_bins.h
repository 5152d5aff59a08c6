// Binning for SAH builders (Wald 2007): items by centroid into slabs along each axis, and the
// cheapest plane between slabs. Boxes are kept four floats wide, for the compiler's vector
// operations.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/structures/bvh.h"

namespace mdk {

inline constexpr int kMaxBins = 1024;

struct alignas(16) Quad {
  float v[4];

  static Quad filled(float a) { return {{a, a, a, a}}; }
};

inline float least(float a, float b) { return a < b ? a : b; }
inline float greatest(float a, float b) { return a > b ? a : b; }

// Loops that are left standing become one vector operation; unrolled ones do not.
inline Quad least(const Quad& a, const Quad& b) {
  Quad r;
#pragma GCC unroll 1
  for (int k = 0; k < 4; ++k) r.v[k] = least(a.v[k], b.v[k]);
  return r;
}
inline Quad greatest(const Quad& a, const Quad& b) {
  Quad r;
#pragma GCC unroll 1
  for (int k = 0; k < 4; ++k) r.v[k] = greatest(a.v[k], b.v[k]);
  return r;
}

/// The fourth lanes hold nothing of meaning.
struct QuadBox {
  Quad lo = Quad::filled(std::numeric_limits<float>::infinity());
  Quad hi = Quad::filled(-std::numeric_limits<float>::infinity());

  void extend(const QuadBox& b) {
    lo = least(lo, b.lo);
    hi = greatest(hi, b.hi);
  }
  void extend(const Quad& p) {
    lo = least(lo, p);
    hi = greatest(hi, p);
  }
  Aabb box() const { return {{lo.v[0], lo.v[1], lo.v[2]}, {hi.v[0], hi.v[1], hi.v[2]}}; }
  float half_area() const {
    const float x = hi.v[0] - lo.v[0], y = hi.v[1] - lo.v[1], z = hi.v[2] - lo.v[2];
    return x * y + (x + y) * z;
  }
  float edge_length() const {
    return (hi.v[0] - lo.v[0]) + (hi.v[1] - lo.v[1]) + (hi.v[2] - lo.v[2]);
  }
};

/// A box and its number, moved together so that a pass over a node reads memory in order.
class BuildItem {
 public:
  BuildItem() = default;
  BuildItem(const Aabb& box, std::uint32_t index)
      : box_{{{box.lo.x, box.lo.y, box.lo.z, std::bit_cast<float>(index | kTag)}},
             {{box.hi.x, box.hi.y, box.hi.z, 0}}} {}

  const QuadBox& box() const { return box_; }
  std::uint32_t index() const { return std::bit_cast<std::uint32_t>(box_.lo.v[3]) & ~kTag; }
  /// Halved before they are added, so that the sum stays in the range of float.
  Quad centroid() const {
    Quad c;
#pragma GCC unroll 1
    for (int k = 0; k < 4; ++k) c.v[k] = box_.lo.v[k] * 0.5f + box_.hi.v[k] * 0.5f;
    return c;
  }

 private:
  /// Makes the number's bits those of an ordinary float: arithmetic on the spare lane is harmless.
  static constexpr std::uint32_t kTag = 0x40000000u;
  QuadBox box_{Quad{}, Quad{}};
};

/// What is known of a run of items before it is looked at.
struct RunBounds {
  QuadBox box, centroids;

  void add(const BuildItem& item) {
    box.extend(item.box());
    centroids.extend(item.centroid());
  }
  void merge(const RunBounds& b) {
    box.extend(b.box);
    centroids.extend(b.centroids);
  }
};

/// Which bin of each axis a centroid falls into.
class Binning {
 public:
  Binning(const QuadBox& centroids, int bins);

  int bins() const { return static_cast<int>(last_.v[0]) + 1; }
  /// Centroids along the axis all fall into bin 0.
  bool is_blind(std::size_t axis) const { return !(scale_.v[axis] > 0); }
  std::array<std::int32_t, 4> bin(const Quad& c) const {
    std::array<std::int32_t, 4> b;
#pragma GCC unroll 1
    for (std::size_t k = 0; k < 4; ++k) {
      b[k] = static_cast<std::int32_t>(least((c.v[k] - lo_.v[k]) * scale_.v[k], last_.v[k]));
    }
    return b;
  }

 private:
  Quad lo_, scale_, last_;
};

struct SahSplit {
  float cost = std::numeric_limits<float>::infinity();
  std::size_t axis = 0;
  std::int32_t plane = 0;  ///< items in bins below it go to the first child
  std::uint32_t below_count = 0;

  bool found() const { return below_count != 0; }
};

/// The bins of a run of items, along all three axes.
class Bins {
 public:
  void clear(int bins);
  void add(std::span<const BuildItem> items, const Binning& binning);
  void merge(const Bins& other);

  /// The plane where measure * tests summed over both sides is least; `box` is that of all items.
  /// Not found where no plane parts them, or costs are past the range of float.
  SahSplit best_split(const Binning& binning, const QuadBox& box, const BvhBuildConfig& config);
  /// Items in bins below `plane`.
  std::uint32_t count_below(std::size_t axis, std::int32_t plane) const;

 private:
  struct Bin {
    QuadBox box;
    std::uint32_t count = 0;
  };
  std::size_t bins_ = 0;
  std::array<std::vector<Bin>, 3> bin_;
  std::vector<float> cost_below_;
};

/// What a leaf of `count` items costs, in tests of a block.
inline float block_tests(std::uint32_t count, std::uint32_t block) {
  return static_cast<float>((count + block - 1) / block);
}

}  // namespace mdk
