// A vector holds one coordinate of as many points as it has lanes. Sums have kSumLanes lanes
// whatever the vector's width: a narrower vector takes them in several passes, so that each lane
// adds up the same points in the same order.
#include "preprocess/simd/point_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "preprocess/simd/point_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace points {
namespace hn = hwy::HWY_NAMESPACE;

using SumTag = hn::CappedTag<double, kSumLanes>;
using SumVec = hn::Vec<SumTag>;
using FloatTag = hn::ScalableTag<float>;
using FloatVec = hn::Vec<FloatTag>;

HWY_INLINE SumVec load_as_double(const float* p) {
  return hn::PromoteTo(SumTag(), hn::LoadU(hn::Rebind<float, SumTag>(), p));
}

HWY_INLINE SumVec add_product(SumVec sum, SumVec a, SumVec b) {
  return hn::Add(sum, hn::Mul(a, b));
}

double lane_total(const double* lane) {
  return ((lane[0] + lane[1]) + (lane[2] + lane[3])) + ((lane[4] + lane[5]) + (lane[6] + lane[7]));
}

void Second(const PointRow& points, const float* weights, std::size_t n, SecondMoments& moments) {
  const SumTag d;
  double lanes[9][kSumLanes];
  for (std::size_t part = 0; part < kSumLanes; part += hn::Lanes(d)) {
    SumVec x = hn::Zero(d), y = x, z = x, xx = x, yy = x, zz = x, xy = x, yz = x, zx = x;
    for (std::size_t i = part; i < n; i += kSumLanes) {
      const SumVec w = load_as_double(weights + i);
      const SumVec px = load_as_double(points.x + i), py = load_as_double(points.y + i),
                   pz = load_as_double(points.z + i);
      const SumVec wx = hn::Mul(w, px), wy = hn::Mul(w, py), wz = hn::Mul(w, pz);
      x = hn::Add(x, wx);
      y = hn::Add(y, wy);
      z = hn::Add(z, wz);
      xx = add_product(xx, wx, px);
      yy = add_product(yy, wy, py);
      zz = add_product(zz, wz, pz);
      xy = add_product(xy, wx, py);
      yz = add_product(yz, wy, pz);
      zx = add_product(zx, wz, px);
    }
    const SumVec sums[9] = {x, y, z, xx, yy, zz, xy, yz, zx};
    for (int s = 0; s < 9; ++s) hn::StoreU(sums[s], d, &lanes[s][part]);
  }
  double total[9];
  for (int s = 0; s < 9; ++s) total[s] = lane_total(lanes[s]);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    moments.first[i] = total[i];
    moments.second[i][i] = total[3 + i];
    moments.second[i][j] = moments.second[j][i] = total[6 + i];
  }
}

void Cross(const PointRow& points, const PointRow& targets, const float* weights, std::size_t n,
           double (&sum)[3][3]) {
  const SumTag d;
  double lanes[9][kSumLanes];
  for (std::size_t part = 0; part < kSumLanes; part += hn::Lanes(d)) {
    SumVec xx = hn::Zero(d), xy = xx, xz = xx, yx = xx, yy = xx, yz = xx, zx = xx, zy = xx, zz = xx;
    for (std::size_t i = part; i < n; i += kSumLanes) {
      const SumVec w = load_as_double(weights + i);
      const SumVec px = load_as_double(points.x + i), py = load_as_double(points.y + i),
                   pz = load_as_double(points.z + i);
      const SumVec tx = hn::Mul(w, load_as_double(targets.x + i)),
                   ty = hn::Mul(w, load_as_double(targets.y + i)),
                   tz = hn::Mul(w, load_as_double(targets.z + i));
      xx = add_product(xx, tx, px);
      xy = add_product(xy, tx, py);
      xz = add_product(xz, tx, pz);
      yx = add_product(yx, ty, px);
      yy = add_product(yy, ty, py);
      yz = add_product(yz, ty, pz);
      zx = add_product(zx, tz, px);
      zy = add_product(zy, tz, py);
      zz = add_product(zz, tz, pz);
    }
    const SumVec sums[9] = {xx, xy, xz, yx, yy, yz, zx, zy, zz};
    for (int s = 0; s < 9; ++s) hn::StoreU(sums[s], d, &lanes[s][part]);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) sum[i][j] = lane_total(lanes[3 * i + j]);
}

/// One coordinate of mapped points.
struct MapRow {
  FloatVec x, y, z, shift;

  explicit MapRow(const float (&m)[4])
      : x(hn::Set(FloatTag(), m[0])),
        y(hn::Set(FloatTag(), m[1])),
        z(hn::Set(FloatTag(), m[2])),
        shift(hn::Set(FloatTag(), m[3])) {}

  HWY_INLINE FloatVec of(FloatVec px, FloatVec py, FloatVec pz) const {
    return hn::Add(offset(px, py, pz), shift);
  }
  HWY_INLINE FloatVec distance(FloatVec px, FloatVec py, FloatVec pz, const float* target) const {
    return hn::Add(offset(px, py, pz), hn::Sub(shift, hn::LoadU(FloatTag(), target)));
  }

 private:
  HWY_INLINE FloatVec offset(FloatVec px, FloatVec py, FloatVec pz) const {
    return hn::Add(hn::Add(hn::Mul(x, px), hn::Mul(y, py)), hn::Mul(z, pz));
  }
};

/// Boxes of as many points as a vector has lanes, kept in registers over all rows.
struct BoxVec {
  FloatVec lo[3], hi[3];

  HWY_INLINE BoxVec(const BoxRow& boxes, std::size_t i) {
    const FloatTag d;
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = hn::LoadU(d, boxes.lo[axis] + i);
      hi[axis] = hn::LoadU(d, boxes.hi[axis] + i);
    }
  }
  HWY_INLINE void extend(int axis, FloatVec p) {
    lo[axis] = hn::Min(lo[axis], p);
    hi[axis] = hn::Max(hi[axis], p);
  }
  HWY_INLINE void store(const BoxRow& boxes, std::size_t i) const {
    const FloatTag d;
    for (int axis = 0; axis < 3; ++axis) {
      hn::StoreU(lo[axis], d, boxes.lo[axis] + i);
      hn::StoreU(hi[axis], d, boxes.hi[axis] + i);
    }
  }
};

void Extend(const MappedRows& rows, std::size_t n, const BoxRow& boxes) {
  const FloatTag d;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    BoxVec box(boxes, i);
    for (std::size_t row = 0; row < rows.count; ++row) {
      const Affine3f& map = rows.maps[row * rows.map_step];
      const std::size_t at = row * rows.stride + i;
      const FloatVec x = hn::LoadU(d, rows.first.x + at), y = hn::LoadU(d, rows.first.y + at),
                     z = hn::LoadU(d, rows.first.z + at);
      box.extend(0, MapRow(map.m[0]).of(x, y, z));
      box.extend(1, MapRow(map.m[1]).of(x, y, z));
      box.extend(2, MapRow(map.m[2]).of(x, y, z));
    }
    box.store(boxes, i);
  }
  for (; i < n; ++i)
    for (std::size_t row = 0; row < rows.count; ++row)
      for (int axis = 0; axis < 3; ++axis) {
        const float* m = rows.maps[row * rows.map_step].m[axis];
        const std::size_t at = row * rows.stride + i;
        const float p =
            m[0] * rows.first.x[at] + m[1] * rows.first.y[at] + m[2] * rows.first.z[at] + m[3];
        float &lo = boxes.lo[axis][i], &hi = boxes.hi[axis][i];
        lo = p < lo ? p : lo;
        hi = p > hi ? p : hi;
      }
}

void TriangleAreas(const std::uint32_t* corners, std::size_t triangles, const BoxRow& boxes,
                   const float (&weights)[3], float* areas) {
  const FloatTag d;
  const hn::Rebind<std::int32_t, FloatTag> di;
  const hn::Rebind<std::uint32_t, FloatTag> du;
  const FloatVec xy = hn::Set(d, weights[0]), yz = hn::Set(d, weights[1]),
                 zx = hn::Set(d, weights[2]);
  std::size_t t = 0;
  for (; t + hn::Lanes(d) <= triangles; t += hn::Lanes(d)) {
    hn::Vec<decltype(du)> a, b, c;
    hn::LoadInterleaved3(du, corners + 3 * t, a, b, c);
    const auto extent = [&](int axis) {
      const auto of = [&](const float* side, auto corner) {
        return hn::GatherIndex(d, side, hn::BitCast(di, corner));
      };
      const float *l = boxes.lo[axis], *h = boxes.hi[axis];
      return hn::Sub(hn::Max(hn::Max(of(h, a), of(h, b)), of(h, c)),
                     hn::Min(hn::Min(of(l, a), of(l, b)), of(l, c)));
    };
    const FloatVec x = extent(0), y = extent(1), z = extent(2);
    const FloatVec sum = hn::Add(hn::Add(hn::Mul(hn::Mul(xy, x), y), hn::Mul(hn::Mul(yz, y), z)),
                                 hn::Mul(hn::Mul(zx, z), x));
    hn::StoreU(hn::Add(sum, sum), d, areas + t);
  }
  for (; t < triangles; ++t) {
    float e[3];
    for (int axis = 0; axis < 3; ++axis) {
      const float *l = boxes.lo[axis], *h = boxes.hi[axis];
      const std::uint32_t* v = corners + 3 * t;
      e[axis] = std::max(std::max(h[v[0]], h[v[1]]), h[v[2]]) -
                std::min(std::min(l[v[0]], l[v[1]]), l[v[2]]);
    }
    const float sum =
        (weights[0] * e[0] * e[1] + weights[1] * e[1] * e[2]) + weights[2] * e[2] * e[0];
    areas[t] = sum + sum;
  }
}

void AddDistances(const Affine3f& map, const PointRow& points, const PointRow& targets,
                  std::size_t n, float* out) {
  const FloatTag d;
  const MapRow first(map.m[0]), second(map.m[1]), third(map.m[2]);
  const float* const target[3] = {targets.x, targets.y, targets.z};
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) {
    const FloatVec x = hn::LoadU(d, points.x + i), y = hn::LoadU(d, points.y + i),
                   z = hn::LoadU(d, points.z + i);
    const FloatVec dx = first.distance(x, y, z, targets.x + i),
                   dy = second.distance(x, y, z, targets.y + i),
                   dz = third.distance(x, y, z, targets.z + i);
    const FloatVec sum = hn::Add(hn::Add(hn::LoadU(d, out + i), hn::Mul(dx, dx)), hn::Mul(dy, dy));
    hn::StoreU(hn::Add(sum, hn::Mul(dz, dz)), d, out + i);
  }
  for (; i < n; ++i)
    for (int axis = 0; axis < 3; ++axis) {
      const float* m = map.m[axis];
      const float p =
          m[0] * points.x[i] + m[1] * points.y[i] + m[2] * points.z[i] + (m[3] - target[axis][i]);
      out[i] += p * p;
    }
}

using LaneTag = hn::CappedTag<float, kSumLanes>;
using LaneVec = hn::Vec<LaneTag>;

/// u of as many points as `d` has lanes, from point i on.
template <class D>
HWY_INLINE hn::Vec<D> scaled(D d, const ScaledCoordinate& u, const PointRow& points,
                             std::size_t i) {
  const auto x = hn::Mul(hn::Set(d, u.map[0]), hn::LoadU(d, points.x + i));
  const auto y = hn::Mul(hn::Set(d, u.map[1]), hn::LoadU(d, points.y + i));
  const auto z = hn::Mul(hn::Set(d, u.map[2]), hn::LoadU(d, points.z + i));
  const auto shift = hn::Sub(hn::Set(d, u.map[3]), hn::LoadU(d, u.middles + i));
  return hn::Mul(hn::Add(hn::Add(hn::Add(x, y), z), shift), hn::LoadU(d, u.reciprocals + i));
}

void AddPowers(const ScaledCoordinate& u, const PointRow& points, std::size_t n, float* sum) {
  const auto add_from = [&](auto d, std::size_t i) {
    const auto u1 = scaled(d, u, points, i);
    const auto u2 = hn::Mul(u1, u1), u4 = hn::Mul(u2, u2), u8 = hn::Mul(u4, u4);
    hn::StoreU(hn::Add(hn::LoadU(d, sum + i), hn::Mul(u8, u8)), d, sum + i);
  };
  const FloatTag d;
  std::size_t i = 0;
  for (; i + hn::Lanes(d) <= n; i += hn::Lanes(d)) add_from(d, i);
  for (; i < n; ++i) add_from(hn::CappedTag<float, 1>(), i);
}

void AddPulls(const ScaledCoordinate& u, const PointRow& points, const float* weights,
              std::size_t n, double* sum) {
  const LaneTag d;
  float lanes[4][kSumLanes];
  for (std::size_t part = 0; part < kSumLanes; part += hn::Lanes(d)) {
    LaneVec x = hn::Zero(d), y = x, z = x, one = x;
    for (std::size_t i = part; i < n; i += kSumLanes) {
      const LaneVec u1 = scaled(d, u, points, i);
      const LaneVec u2 = hn::Mul(u1, u1), u4 = hn::Mul(u2, u2), u8 = hn::Mul(u4, u4);
      const LaneVec u15 = hn::Mul(hn::Mul(u8, u4), hn::Mul(u2, u1));
      const LaneVec pull = hn::Mul(hn::LoadU(d, weights + i), u15);
      x = hn::Add(x, hn::Mul(pull, hn::LoadU(d, points.x + i)));
      y = hn::Add(y, hn::Mul(pull, hn::LoadU(d, points.y + i)));
      z = hn::Add(z, hn::Mul(pull, hn::LoadU(d, points.z + i)));
      one = hn::Add(one, pull);
    }
    const LaneVec sums[4] = {x, y, z, one};
    for (int s = 0; s < 4; ++s) hn::StoreU(sums[s], d, &lanes[s][part]);
  }
  for (int s = 0; s < 4; ++s)
    for (std::size_t l = 0; l < kSumLanes; ++l) sum[s] += static_cast<double>(lanes[s][l]);
}

}  // namespace points
using points::AddDistances, points::AddPowers, points::AddPulls;
using points::Cross, points::Extend, points::Second, points::TriangleAreas;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(Second);
HWY_EXPORT(Cross);
HWY_EXPORT(Extend);
HWY_EXPORT(TriangleAreas);
HWY_EXPORT(AddDistances);
HWY_EXPORT(AddPowers);
HWY_EXPORT(AddPulls);

SecondMoments second_moments(const PointRow& points, const float* weights, std::size_t n) {
  SecondMoments moments;
  HWY_DYNAMIC_DISPATCH(Second)(points, weights, n, moments);
  return moments;
}

void cross_moments(const PointRow& points, const PointRow& targets, const float* weights,
                   std::size_t n, double (&sum)[3][3]) {
  HWY_DYNAMIC_DISPATCH(Cross)(points, targets, weights, n, sum);
}

void extend_boxes(const MappedRows& rows, std::size_t n, const BoxRow& boxes) {
  HWY_DYNAMIC_DISPATCH(Extend)(rows, n, boxes);
}

void triangle_box_areas(const std::uint32_t* corners, std::size_t triangles, const BoxRow& boxes,
                        const float (&weights)[3], float* areas) {
  HWY_DYNAMIC_DISPATCH(TriangleAreas)(corners, triangles, boxes, weights, areas);
}

void add_squared_distances(const Affine3f& map, const PointRow& points, const PointRow& targets,
                           std::size_t n, float* out) {
  HWY_DYNAMIC_DISPATCH(AddDistances)(map, points, targets, n, out);
}

void add_sixteenth_powers(const ScaledCoordinate& u, const PointRow& points, std::size_t n,
                          float* sum) {
  HWY_DYNAMIC_DISPATCH(AddPowers)(u, points, n, sum);
}

void add_pulls(const ScaledCoordinate& u, const PointRow& points, const float* weights,
               std::size_t n, double (&sum)[4]) {
  HWY_DYNAMIC_DISPATCH(AddPulls)(u, points, weights, n, sum);
}

}  // namespace mdk
#endif  // HWY_ONCE
