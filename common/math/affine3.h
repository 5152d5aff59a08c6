// Affine3: x -> L x + t, a 3x4 matrix stored row by row. Plain data, as the file holds it.
#pragma once

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

}  // namespace mdk
