// ScaledRay: a caller's ray, which must outlive it, as the kernels take it.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/trace/kernels/ray_kernels.h"
#include "mdk/ray_query.h"

namespace mdk {

/// 2^exponent, for exponents of normal numbers of double.
inline double power_of_two(int exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

/// The largest component of the direction brought into [1, 2) by a power of two, which rounds
/// nothing; t then counts in other lengths, so bounds and results are scaled likewise. What is
/// farther than the largest float, in the caller's lengths, is not hit.
struct ScaledRay {
  WorldRay ray;
  const QueryRay& query;
  bool usable = false;

  explicit ScaledRay(const QueryRay& q) : query(q) {
    const float longest = std::max(std::max(std::abs(q.direction.x), std::abs(q.direction.y)),
                                   std::abs(q.direction.z));
    // Nothing that is not finite gives 0.
    const float zero = (q.origin.x * 0 + q.origin.y * 0) + (q.origin.z * 0 + q.direction.x * 0) +
                       (q.direction.y * 0 + q.direction.z * 0);
    usable = (zero == 0) & (longest > 0) & (q.t_max > q.t_min);
    if (!usable) return;
    const auto bits = std::bit_cast<std::uint64_t>(static_cast<double>(longest));
    const int exponent = static_cast<int>(bits >> 52) - 1023;
    t_scale_ = power_of_two(exponent);
    inverse_ = power_of_two(-exponent);
    ray = {to_double(q.origin), to_double(q.direction) * inverse_, scaled(q.t_min)};
    t_max_ = std::min(std::min(scaled(q.t_max), scaled(kLargest)), kLargest);
  }

  RayHit nothing_yet() const {
    RayHit hit;
    hit.t = t_max_;
    return hit;
  }
  /// A t of the caller's in our lengths.
  float scaled(float t) const { return static_cast<float>(t * t_scale_); }
  /// What directions were multiplied by.
  double direction_scale() const { return inverse_; }
  QueryHit in_callers_lengths(const RayHit& hit) const {
    if (hit.triangle == kNoHit) return {};
    return {static_cast<float>(hit.t * inverse_), hit.triangle, hit.bary1, hit.bary2};
  }

 private:
  static constexpr float kLargest = std::numeric_limits<float>::max();

  double t_scale_ = 1, inverse_ = 1;  ///< from the caller's t to ours, and back
  float t_max_ = 0;
};

}  // namespace mdk
