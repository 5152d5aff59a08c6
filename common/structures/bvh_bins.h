// Binning for the SAH (Wald 2007): items by centroid into slabs along each axis, and the cheapest
// plane between slabs. Part of bvh_builder.cpp. Boxes are kept four floats wide, for the compiler's
// vector operations.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
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

inline float min(float a, float b) { return a < b ? a : b; }
inline float max(float a, float b) { return a > b ? a : b; }

// Loops that are left standing become one vector operation; unrolled ones do not.
inline Quad min(const Quad& a, const Quad& b) {
  Quad r;
#pragma GCC unroll 1
  for (int k = 0; k < 4; ++k) r.v[k] = min(a.v[k], b.v[k]);
  return r;
}
inline Quad max(const Quad& a, const Quad& b) {
  Quad r;
#pragma GCC unroll 1
  for (int k = 0; k < 4; ++k) r.v[k] = max(a.v[k], b.v[k]);
  return r;
}

/// The fourth lanes hold nothing of meaning.
struct QuadBox {
  Quad lo = Quad::filled(std::numeric_limits<float>::infinity());
  Quad hi = Quad::filled(-std::numeric_limits<float>::infinity());

  void extend(const QuadBox& b) {
    lo = min(lo, b.lo);
    hi = max(hi, b.hi);
  }
  void extend(const Quad& p) {
    lo = min(lo, p);
    hi = max(hi, p);
  }
  Aabb box() const { return {{lo.v[0], lo.v[1], lo.v[2]}, {hi.v[0], hi.v[1], hi.v[2]}}; }
  bool has_area() const { return half_area() > 0; }
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

  RunBounds() = default;
  explicit RunBounds(std::span<const BuildItem> items) {
    for (const BuildItem& item : items) add(item);
  }
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
  Binning(const QuadBox& centroids, int bins)
      : lo_(centroids.lo), last_(Quad::filled(static_cast<float>(bins - 1))) {
    // Where the range is a point, or too short or too long to be scaled, all fall into bin 0.
    const auto scale = [&](float lo, float hi) {
      const float per_length = static_cast<float>(bins) / (hi - lo);
      return std::isfinite(per_length) ? per_length : 0.0f;
    };
    for (std::size_t k = 0; k < 3; ++k) scale_.v[k] = scale(centroids.lo.v[k], centroids.hi.v[k]);
    scale_.v[3] = 0;
  }

  int bins() const { return static_cast<int>(last_.v[0]) + 1; }
  /// Centroids along the axis all fall into bin 0.
  bool is_blind(std::size_t axis) const { return !(scale_.v[axis] > 0); }
  std::array<std::int32_t, 4> bin(const Quad& c) const {
    std::array<std::int32_t, 4> b;
#pragma GCC unroll 1
    for (std::size_t k = 0; k < 4; ++k) {
      b[k] = static_cast<std::int32_t>(min((c.v[k] - lo_.v[k]) * scale_.v[k], last_.v[k]));
    }
    return b;
  }

 private:
  Quad lo_, scale_, last_;
};

/// A plane between bins; as it begins, none.
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
  void clear(int bins) {
    bins_ = static_cast<std::size_t>(bins);
    for (std::vector<Bin>& axis : bin_) {
      if (axis.size() < bins_) axis.resize(bins_);
      std::fill_n(axis.begin(), bins_, Bin{});
    }
    if (cost_below_.size() < bins_) cost_below_.resize(bins_);
  }

  void add(std::span<const BuildItem> items, const Binning& binning) {
    Bin* const x = bin_[0].data();
    Bin* const y = bin_[1].data();
    Bin* const z = bin_[2].data();
    const auto put = [](Bin& bin, const QuadBox& box) {
      bin.box.extend(box);
      ++bin.count;
    };
    for (const BuildItem& item : items) {
      const auto b = binning.bin(item.centroid());
      const QuadBox box = item.box();
      put(x[b[0]], box);
      put(y[b[1]], box);
      put(z[b[2]], box);
    }
  }

  void merge(const Bins& other) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t b = 0; b < bins_; ++b) {
        bin_[axis][b].box.extend(other.bin_[axis][b].box);
        bin_[axis][b].count += other.bin_[axis][b].count;
      }
  }

  /// The plane where measure * tests summed over both sides is smallest; `whole` is the box of all
  /// items. Not found where no plane parts them, or costs are past the range of float.
  SahSplit best_split(const Binning& binning, const QuadBox& whole, const BvhBuildConfig& config) {
    // By area, or by length where all boxes lie on a line and no area is left to compare.
    const bool by_area = whole.has_area();
    const auto cost = [&](const QuadBox& box, std::uint32_t count) {
      const float measure = by_area ? box.half_area() : box.edge_length();
      return count == 0 ? 0.0f : measure * config.leaf_tests(count);
    };
    SahSplit best;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (binning.is_blind(axis)) continue;
      const std::vector<Bin>& bins = bin_[axis];
      QuadBox box;
      std::uint32_t count = 0;
      for (std::size_t plane = 1; plane < bins_; ++plane) {
        box.extend(bins[plane - 1].box);
        count += bins[plane - 1].count;
        cost_below_[plane] = cost(box, count);
      }
      const std::uint32_t all = count + bins[bins_ - 1].count;
      box = {};
      count = 0;
      for (std::size_t plane = bins_ - 1; plane > 0; --plane) {
        box.extend(bins[plane].box);
        count += bins[plane].count;
        const float sum = cost_below_[plane] + cost(box, count);
        if (count != 0 && count != all && sum < best.cost)
          best = {sum, axis, static_cast<std::int32_t>(plane), all - count};
      }
    }
    return best;
  }

  /// Items in bins below the plane.
  std::uint32_t count_below(const SahSplit& split) const {
    std::uint32_t count = 0;
    for (std::size_t b = 0; b < static_cast<std::size_t>(split.plane); ++b)
      count += bin_[split.axis][b].count;
    return count;
  }

 private:
  struct Bin {
    QuadBox box;
    std::uint32_t count = 0;
  };
  std::size_t bins_ = 0;
  std::array<std::vector<Bin>, 3> bin_;
  std::vector<float> cost_below_;
};

}  // namespace mdk
