// Rays of a beam against blocks of triangles. Seen along the beam a ray is a point o and a triangle
// is flat, so with a, b, c its corners less o:
//
//     E_ab = a x b = a_u b_v - a_v b_u         which side of edge ab the ray passes; exactly
//                                              negated when a and b change places
//     hit where the three have one sign (0 counts as both), o is within the corners' bounds,
//     and |E_bc| (a_w - o_w) + |E_ca| (b_w - o_w) + |E_ab| (c_w - o_w) > 0
//
// Corners are projected alike for every triangle they belong to, so no ray slips between
// neighbours. A hit implies that o_u and o_v are within the corners' bounds and that a corner has a
// larger w: that is all that boxes are culled by.
#include <limits>

#include "common/simd/lanes-inl.h"
#include "common/trace/kernels/beam_kernels.h"

#if defined(MDK_BEAM_TEST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef MDK_BEAM_TEST_INL_H_
#undef MDK_BEAM_TEST_INL_H_
#else
#define MDK_BEAM_TEST_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace beams {

static_assert(kBeamGroup == kBlockTriangles);

/// Where rays start: nothing that ends below `w` or lies beside [u0, u1] x [v0, v1] is hit.
struct BeamBounds {
  float u0, u1, v0, v1, w;
};

/// Fetches a block's corners.
HWY_INLINE void pose_block(const TriangleBlock& block, const Vec3f* positions, PosedBlock& out) {
  const FloatTag d;
  for (std::size_t i = 0; i < block.count; i += hn::Lanes(d))
    for (std::size_t k = 0; k < 3; ++k) {
      store(d, gather(d, block.corner[k] + i, positions), out.x[k] + i, out.y[k] + i, out.z[k] + i);
    }
}

/// The rays that are not yet occluded, in groups of sixteen.
class BeamRays {
 public:
  explicit BeamRays(RayBeam& beam) : beam_(beam) {
    for (std::uint32_t first = 0; first < beam.count; first += kBeamGroup) {
      const std::uint32_t rays = std::min(beam.count - first, kBeamGroup);
      for (std::uint32_t i = first + rays; i < first + kBeamGroup; ++i) {  // numbers, if not rays
        beam.u[i] = beam.u[first];
        beam.v[i] = beam.v[first];
        beam.w[i] = beam.w[first];
      }
      const std::size_t g = first / kBeamGroup;
      alive_[g] = static_cast<std::uint16_t>((1u << rays) - 1u);
      groups_ |= 1u << g;
      group_u0_[g] = min_of_sixteen(beam.u + first);
      group_u1_[g] = max_of_sixteen(beam.u + first);
      group_v0_[g] = min_of_sixteen(beam.v + first);
      group_v1_[g] = max_of_sixteen(beam.v + first);
      group_w_[g] = min_of_sixteen(beam.w + first);
    }
    set_bounds();
  }

  bool all_occluded() const { return groups_ == 0; }
  /// Of all rays that are left.
  const BeamBounds& bounds() const { return bounds_; }
  /// Grows whenever bounds() has changed.
  std::uint32_t version() const { return version_; }

  /// `count`: of the block's triangles.
  void test(const PosedBlock& block, std::uint32_t count) {
    std::uint32_t near = project(block, count);
    for (; near != 0 && groups_ != 0; near &= near - 1)
      test_triangle(static_cast<std::size_t>(__builtin_ctz(near)));
    if (!changed_) return;
    changed_ = false;
    set_bounds();
  }

 private:
  /// The corners of sixteen triangles, and their bounds.
  struct Projected {
    alignas(64) float u[3][kBlockTriangles], v[3][kBlockTriangles], w[3][kBlockTriangles];
    alignas(64) float u0[kBlockTriangles], u1[kBlockTriangles], v0[kBlockTriangles],
        v1[kBlockTriangles], w1[kBlockTriangles];
  };
  /// A triangle past this is not finite, or as good as.
  static constexpr float kMaxCoordinate = 1e30f;

  static HWY_INLINE FloatVec min_of(const FloatVec (&x)[3]) {
    return hn::Min(hn::Min(x[0], x[1]), x[2]);
  }
  static HWY_INLINE FloatVec max_of(const FloatVec (&x)[3]) {
    return hn::Max(hn::Max(x[0], x[1]), x[2]);
  }
  static HWY_INLINE FloatVec sizes(const FloatVec (&x)[3]) {
    return hn::Add(hn::Add(hn::Abs(x[0]), hn::Abs(x[1])), hn::Abs(x[2]));
  }

  /// Which triangles of the block some ray may hit; fills projected_.
  HWY_INLINE std::uint32_t project(const PosedBlock& block, std::uint32_t count) {
    const FloatTag d;
    const BeamBasis& basis = beam_.basis;
    std::uint32_t near = 0;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
      FloatVec u[3], v[3], w[3];
      for (std::size_t k = 0; k < 3; ++k) {
        const Points<FloatTag> corner{hn::Load(d, block.x[k] + i), hn::Load(d, block.y[k] + i),
                                      hn::Load(d, block.z[k] + i)};
        const auto r = corner - broadcast(d, basis.origin);
        u[k] = dot(broadcast(d, basis.axis[0]), r);
        v[k] = dot(broadcast(d, basis.axis[1]), r);
        w[k] = dot(broadcast(d, basis.axis[2]), r);
        hn::Store(u[k], d, projected_.u[k] + i);
        hn::Store(v[k], d, projected_.v[k] + i);
        hn::Store(w[k], d, projected_.w[k] + i);
      }
      const auto u0 = min_of(u), u1 = max_of(u), v0 = min_of(v), v1 = max_of(v), w1 = max_of(w);
      hn::Store(u0, d, projected_.u0 + i);
      hn::Store(u1, d, projected_.u1 + i);
      hn::Store(v0, d, projected_.v0 + i);
      hn::Store(v1, d, projected_.v1 + i);
      hn::Store(w1, d, projected_.w1 + i);
      const auto sound =
          hn::Lt(hn::Add(hn::Add(sizes(u), sizes(v)), sizes(w)), hn::Set(d, kMaxCoordinate));
      const auto beside_u =
          hn::Or(hn::Lt(u1, hn::Set(d, bounds_.u0)), hn::Gt(u0, hn::Set(d, bounds_.u1)));
      const auto beside_v =
          hn::Or(hn::Lt(v1, hn::Set(d, bounds_.v0)), hn::Gt(v0, hn::Set(d, bounds_.v1)));
      const auto outside = hn::Or(hn::Or(beside_u, beside_v), hn::Lt(w1, hn::Set(d, bounds_.w)));
      near |= mask_bits(d, hn::AndNot(outside, sound)) << i;
    }
    return near & ((1u << count) - 1u);
  }

  HWY_INLINE void test_triangle(std::size_t t) {
    std::uint32_t groups = groups_;
    if ((groups & (groups - 1)) != 0) groups &= groups_overlapping(t);
    for (; groups != 0; groups &= groups - 1)
      test_group(t, static_cast<std::size_t>(__builtin_ctz(groups)));
  }

  /// Groups whose bounds the triangle's overlap.
  HWY_INLINE std::uint32_t groups_overlapping(std::size_t t) const {
    const FloatTag d;
    std::uint32_t near = 0;
    for (std::size_t i = 0; i < kBeamGroups; i += hn::Lanes(d)) {
      const auto u = hn::And(hn::Ge(hn::Set(d, projected_.u1[t]), hn::Load(d, group_u0_ + i)),
                             hn::Le(hn::Set(d, projected_.u0[t]), hn::Load(d, group_u1_ + i)));
      const auto v = hn::And(hn::Ge(hn::Set(d, projected_.v1[t]), hn::Load(d, group_v0_ + i)),
                             hn::Le(hn::Set(d, projected_.v0[t]), hn::Load(d, group_v1_ + i)));
      const auto w = hn::Ge(hn::Set(d, projected_.w1[t]), hn::Load(d, group_w_ + i));
      near |= mask_bits(d, hn::And(hn::And(u, v), w)) << i;
    }
    return near;
  }

  HWY_INLINE void test_group(std::size_t t, std::size_t g) {
    const FloatTag d;
    const auto set = [&](const float(&row)[kBlockTriangles]) { return hn::Set(d, row[t]); };
    const auto zero = hn::Zero(d);
    std::uint32_t hit = 0;
    for (std::size_t i = 0; i < kBeamGroup; i += hn::Lanes(d)) {
      const auto ou = hn::Load(d, beam_.u + g * kBeamGroup + i);
      const auto ov = hn::Load(d, beam_.v + g * kBeamGroup + i);
      const auto au = hn::Sub(set(projected_.u[0]), ou), av = hn::Sub(set(projected_.v[0]), ov);
      const auto bu = hn::Sub(set(projected_.u[1]), ou), bv = hn::Sub(set(projected_.v[1]), ov);
      const auto cu = hn::Sub(set(projected_.u[2]), ou), cv = hn::Sub(set(projected_.v[2]), ov);
      const auto ea = hn::Sub(hn::Mul(bu, cv), hn::Mul(bv, cu));
      const auto eb = hn::Sub(hn::Mul(cu, av), hn::Mul(cv, au));
      const auto ec = hn::Sub(hn::Mul(au, bv), hn::Mul(av, bu));
      const auto front = hn::And(hn::And(hn::Ge(ea, zero), hn::Ge(eb, zero)), hn::Ge(ec, zero));
      const auto back = hn::And(hn::And(hn::Le(ea, zero), hn::Le(eb, zero)), hn::Le(ec, zero));
      const auto in_u = hn::And(hn::Ge(ou, set(projected_.u0)), hn::Le(ou, set(projected_.u1)));
      const auto in_v = hn::And(hn::Ge(ov, set(projected_.v0)), hn::Le(ov, set(projected_.v1)));
      const auto inside = hn::And(hn::Or(front, back), hn::And(in_u, in_v));
      if (hn::AllFalse(d, inside)) continue;
      const auto ow = hn::Load(d, beam_.w + g * kBeamGroup + i);
      const auto depth_a = hn::Mul(hn::Abs(ea), hn::Sub(set(projected_.w[0]), ow));
      const auto depth_b = hn::Mul(hn::Abs(eb), hn::Sub(set(projected_.w[1]), ow));
      const auto depth_c = hn::Mul(hn::Abs(ec), hn::Sub(set(projected_.w[2]), ow));
      const auto beyond = hn::Gt(hn::Add(hn::Add(depth_a, depth_b), depth_c), zero);
      hit |= mask_bits(d, hn::And(inside, beyond)) << i;
    }
    if ((hit & alive_[g]) != 0) occlude(g, hit & alive_[g]);
  }

  HWY_INLINE void occlude(std::size_t g, std::uint32_t rays) {
    beam_.occluded[g] = static_cast<std::uint16_t>(beam_.occluded[g] | rays);
    alive_[g] = static_cast<std::uint16_t>(alive_[g] & ~rays);
    if (alive_[g] != 0) return;
    groups_ &= ~(1u << g);
    changed_ = true;
  }

  void set_bounds() {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    bounds_ = {kInfinity, -kInfinity, kInfinity, -kInfinity, kInfinity};
    for (std::uint32_t rest = groups_; rest != 0; rest &= rest - 1) {
      const auto g = static_cast<std::size_t>(__builtin_ctz(rest));
      bounds_.u0 = std::min(bounds_.u0, group_u0_[g]);
      bounds_.u1 = std::max(bounds_.u1, group_u1_[g]);
      bounds_.v0 = std::min(bounds_.v0, group_v0_[g]);
      bounds_.v1 = std::max(bounds_.v1, group_v1_[g]);
      bounds_.w = std::min(bounds_.w, group_w_[g]);
    }
    ++version_;
  }

  RayBeam& beam_;
  BeamBounds bounds_{};
  std::uint32_t groups_ = 0;  ///< with rays that are left
  std::uint32_t version_ = 0;
  bool changed_ = false;
  // Of groups that have rays.
  std::uint16_t alive_[kBeamGroups];
  alignas(64) float group_u0_[kBeamGroups];
  alignas(64) float group_u1_[kBeamGroups];
  alignas(64) float group_v0_[kBeamGroups];
  alignas(64) float group_v1_[kBeamGroups];
  alignas(64) float group_w_[kBeamGroups];
  Projected projected_;
};

}  // namespace beams
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#endif  // per-target guard
