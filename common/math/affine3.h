// Affine3: x -> L x + t, a 3x4 matrix stored row by row. Plain data, as the file holds it.
// AffinePath: how a cluster's map moves from one key to the next.
#pragma once

#include <algorithm>
#include <cmath>

#include "common/math/vec3.h"

namespace mdk {

template <class T>
struct Affine3 {
  /// m[row][column]; column 3 is the translation.
  T m[3][4] = {{T(1), T(0), T(0), T(0)}, {T(0), T(1), T(0), T(0)}, {T(0), T(0), T(1), T(0)}};

  Vec3<T> point(const Vec3<T>& p) const {
    return {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
            m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
            m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
  }
  Vec3<T> vector(const Vec3<T>& v) const {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
            m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
  }
  /// Column `j` of the linear part (the image of axis j), or the translation for j = 3.
  Vec3<T> column(int j) const { return {m[0][j], m[1][j], m[2][j]}; }

  T determinant() const { return dot(cross(column(0), column(1)), column(2)); }

  bool operator==(const Affine3&) const = default;
};

using Affine3f = Affine3<float>;
using Affine3d = Affine3<double>;

inline Affine3d to_double(const Affine3f& a) {
  Affine3d r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) r.m[i][j] = a.m[i][j];
  return r;
}
inline Affine3f to_float(const Affine3d& a) {
  Affine3f r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) r.m[i][j] = static_cast<float>(a.m[i][j]);
  return r;
}

/// First `b`, then `a`.
template <class T>
Affine3<T> operator*(const Affine3<T>& a, const Affine3<T>& b) {
  Affine3<T> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) {
      r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
      if (j == 3) r.m[i][j] += a.m[i][3];
    }
  return r;
}

/// The map that undoes `a`, whose determinant must not be zero.
inline Affine3d inverse(const Affine3d& a) {
  const double scale = 1 / a.determinant();
  const Vec3d rows[3] = {cross(a.column(1), a.column(2)) * scale,
                         cross(a.column(2), a.column(0)) * scale,
                         cross(a.column(0), a.column(1)) * scale};
  Affine3d r;
  for (int i = 0; i < 3; ++i) {
    r.m[i][0] = rows[i].x;
    r.m[i][1] = rows[i].y;
    r.m[i][2] = rows[i].z;
    r.m[i][3] = -dot(rows[i], a.column(3));
  }
  return r;
}

/// a + s (b - a), entry by entry.
inline Affine3d mix(const Affine3d& a, const Affine3d& b, double s) {
  Affine3d r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) r.m[i][j] = a.m[i][j] + s * (b.m[i][j] - a.m[i][j]);
  return r;
}

/// Bernstein coefficients of det(a + s (b - a)), linear parts: for s in [0, 1] the determinant lies
/// between the smallest and the largest of them.
struct DeterminantBounds {
  double d[4];

  DeterminantBounds(const Affine3d& a, const Affine3d& b)
      : d{a.determinant(), blend(a, b), blend(b, a), b.determinant()} {}

  double min() const { return *std::min_element(d, d + 4); }
  double max() const { return *std::max_element(d, d + 4); }

 private:
  /// Mean over the three ways of taking one column from `once` and the others from `twice`.
  static double blend(const Affine3d& twice, const Affine3d& once) {
    return (dot(cross(once.column(0), twice.column(1)), twice.column(2)) +
            dot(cross(twice.column(0), once.column(1)), twice.column(2)) +
            dot(cross(twice.column(0), twice.column(1)), once.column(2))) /
           3;
  }
};

/// Vertices move linearly in the world, so a rigid part that turns between two keys shrinks a
/// little on the way. The map that follows it exactly is the inverse of the interpolated inverses:
/// with vertices v0 = X0 r and v1 = X1 r at the keys, v0 + s (v1 - v0) = (X0 + s (X1 - X0)) r at
/// every s. Interpolating local_from_world itself would let the vertices of a turning part wander
/// through the local basis, by far more than their residual motion.
///
/// X(s) can become singular (a part that turns by half a circle shrinks to nothing). So its
/// determinant, a cubic, is bounded once per pair of keys by its Bernstein coefficients; where it
/// comes too close to zero, the linear part of local_from_world is interpolated instead, and the
/// local origin moves linearly. The choice depends on the two stored maps alone.
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
    constexpr double kMaxCondition = 1e4;
    const auto squared_norm = [](const Affine3d& m) {
      return dot(m.column(0), m.column(0)) + dot(m.column(1), m.column(1)) +
             dot(m.column(2), m.column(2));
    };
    return squared_norm(a) * squared_norm(inverse_of_a) <= kMaxCondition * kMaxCondition;
  }

  /// Whether all determinant bounds have one sign and similar size. A linear part with an entry
  /// that is not finite has no finite determinant.
  bool stays_regular(int pieces) const {
    constexpr double kMinShare = 1.0 / 16;
    double min = x0_.determinant(), max = min;
    for (int i = 0; i < pieces; ++i) {
      const DeterminantBounds bounds(mix(x0_, x1_, static_cast<double>(i) / pieces),
                                     mix(x0_, x1_, static_cast<double>(i + 1) / pieces));
      min = std::min(min, bounds.min());
      max = std::max(max, bounds.max());
    }
    return (min > 0 && min >= kMinShare * max) || (max < 0 && max <= kMinShare * min);
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
