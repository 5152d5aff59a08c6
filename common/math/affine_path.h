// AffinePath: how a cluster's map moves from one key to the next.
//
// Vertices move linearly in the world, so a rigid part that turns between two keys shrinks a little
// on the way. The map that follows it exactly is the inverse of the interpolated inverses: with
// vertices v0 = X0 r and v1 = X1 r at the keys, v0 + s (v1 - v0) = (X0 + s (X1 - X0)) r at every s.
// Interpolating local_from_world itself would let the vertices of a turning part wander through the
// local basis, by far more than their residual motion.
//
// X(s) can become singular (a part that turns by half a circle shrinks to nothing). So its
// determinant, a cubic, is bounded once per pair of keys by its Bernstein coefficients; where it
// comes too close to zero, the linear part of local_from_world is interpolated instead, and the
// local origin moves linearly. The choice depends on the two stored maps alone.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/affine3.h"

namespace mdk {

/// a + s (b - a), entry by entry.
inline Affine3d mix(const Affine3d& a, const Affine3d& b, double s) {
  Affine3d r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) r.m[i][j] = a.m[i][j] + s * (b.m[i][j] - a.m[i][j]);
  return r;
}

/// Bernstein coefficients of det(a + s (b - a)), linear parts: for s in [0, 1] the determinant lies
/// between the least and the most of them.
struct DeterminantBounds {
  double d[4];

  DeterminantBounds(const Affine3d& a, const Affine3d& b)
      : d{a.determinant(), blend(a, b), blend(b, a), b.determinant()} {}

  double least() const { return *std::min_element(d, d + 4); }
  double most() const { return *std::max_element(d, d + 4); }

 private:
  /// Mean over the three ways of taking one column from `once` and the others from `twice`.
  static double blend(const Affine3d& twice, const Affine3d& once) {
    return (dot(cross(once.column(0), twice.column(1)), twice.column(2)) +
            dot(cross(twice.column(0), once.column(1)), twice.column(2)) +
            dot(cross(twice.column(0), twice.column(1)), once.column(2))) /
           3;
  }
};

class AffinePath {
 public:
  /// From `a` at s = 0 to `b` at s = 1, both local_from_world.
  AffinePath(const Affine3f& a, const Affine3f& b) : a_(to_double(a)), b_(to_double(b)) {
    if (a_.determinant() == 0 || b_.determinant() == 0) return;
    x0_ = inverse(a_);
    x1_ = inverse(b_);
    if (!is_well_conditioned(a_, x0_) || !is_well_conditioned(b_, x1_)) return;
    kind_ = Kind::kOrigin;
    for (const int pieces : {1, 8})
      if (stays_regular(pieces)) {
        kind_ = Kind::kInverse;
        pieces_ = pieces;
        return;
      }
  }

  Affine3d at(float s) const {
    if (s == 0) return a_;
    if (kind_ == Kind::kInverse) return inverse(mix(x0_, x1_, s));
    Affine3d r = mix(a_, b_, s);
    if (kind_ == Kind::kEntries) return r;
    const Vec3d origin = mix(x0_, x1_, s).column(3), shift = r.vector(origin);
    for (int i = 0; i < 3; ++i) r.m[i][3] = -shift[static_cast<std::size_t>(i)];
    return r;
  }

  const Affine3d& from() const { return a_; }
  const Affine3d& to() const { return b_; }

  /// 0 where local positions of linearly moving vertices are quadratic in s. Else the map is the
  /// inverse of mix(inverse_from(), inverse_to(), s), and in each of so many equal pieces of [0, 1]
  /// its DeterminantBounds have one sign.
  int rational_pieces() const { return kind_ == Kind::kInverse ? pieces_ : 0; }
  const Affine3d& inverse_from() const { return x0_; }
  const Affine3d& inverse_to() const { return x1_; }

 private:
  enum class Kind {
    kInverse,  ///< the inverses are interpolated
    kOrigin,   ///< the linear part is, and the local origin moves linearly
    kEntries,  ///< every entry is: a map without a useful inverse (a fit gives none such)
  };

  /// Whether inverting loses few digits; not so for NaN and infinities.
  static bool is_well_conditioned(const Affine3d& a, const Affine3d& inverse_of_a) {
    constexpr double kLargestCondition = 1e4;
    const auto squared_norm = [](const Affine3d& m) {
      return dot(m.column(0), m.column(0)) + dot(m.column(1), m.column(1)) +
             dot(m.column(2), m.column(2));
    };
    return squared_norm(a) * squared_norm(inverse_of_a) <= kLargestCondition * kLargestCondition;
  }

  /// Whether all determinant bounds have one sign and similar size. A linear part with an entry
  /// that is not finite has no finite determinant.
  bool stays_regular(int pieces) const {
    constexpr double kSmallestShare = 1.0 / 16;
    double least = x0_.determinant(), most = least;
    for (int i = 0; i < pieces; ++i) {
      const DeterminantBounds bounds(mix(x0_, x1_, static_cast<double>(i) / pieces),
                                     mix(x0_, x1_, static_cast<double>(i + 1) / pieces));
      least = std::min(least, bounds.least());
      most = std::max(most, bounds.most());
    }
    return (least > 0 && least >= kSmallestShare * most) ||
           (most < 0 && most <= kSmallestShare * least);
  }

  Affine3d a_, b_, x0_, x1_;
  Kind kind_ = Kind::kEntries;
  int pieces_ = 1;
};

/// Between two keys. What the fuzzy boxes bound and what tracing uses is this one formula
/// (docs/method.md, time between keys).
inline Affine3d interpolate(const Affine3f& a, const Affine3f& b, float s) {
  return s == 0 ? to_double(a) : AffinePath(a, b).at(s);
}

}  // namespace mdk
