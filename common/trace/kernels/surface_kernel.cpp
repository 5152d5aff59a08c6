// All rays of a picture leave one eye, so barycentric coordinates are linear over the image but for
// a common factor: with corners a, b, c seen from the eye, the weight of c at the ray d is
//
//     ((b - a) x (b + a)) . d,    d = corner + X du + Y dv
//
// A vector of pixels that shows few triangles is worked triangle by triangle, each set up once for
// all its pixels in the tile; one that shows many is worked with a triangle a lane. Both compute
// the same formulas.
#include "common/trace/kernels/surface_kernel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/surface_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::CappedTag<float, kTileSide>;
using FloatVec = hn::Vec<FloatTag>;

template <class D>
using IndexVec = hn::Vec<hn::RebindToSigned<D>>;

/// x, y, z of one vector per lane.
template <class D>
struct Vectors {
  hn::Vec<D> x, y, z;
};

template <class D>
HWY_INLINE Vectors<D> broadcast(D d, const Vec3f& v) {
  return {hn::Set(d, v.x), hn::Set(d, v.y), hn::Set(d, v.z)};
}
template <class D>
HWY_INLINE Vectors<D> scaled(const Vectors<D>& v, hn::Vec<D> s) {
  return {hn::Mul(v.x, s), hn::Mul(v.y, s), hn::Mul(v.z, s)};
}
template <class D>
HWY_INLINE Vectors<D> sum(const Vectors<D>& a, const Vectors<D>& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
template <class D>
HWY_INLINE Vectors<D> difference(const Vectors<D>& a, const Vectors<D>& b) {
  return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
template <class D>
HWY_INLINE hn::Vec<D> dot_product(const Vectors<D>& a, const Vectors<D>& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
template <class D>
HWY_INLINE Vectors<D> cross_product(const Vectors<D>& a, const Vectors<D>& b) {
  return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
          hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
          hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}
template <class D>
HWY_INLINE Vectors<D> choose(hn::Mask<D> mask, const Vectors<D>& yes, const Vectors<D>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}
/// `v` where not `keep`, else with the sign turned.
template <class D>
HWY_INLINE Vectors<D> negated_unless(D d, hn::Mask<D> keep, const Vectors<D>& v) {
  const auto zero = hn::Zero(d);
  return choose<D>(keep, v, {hn::Sub(zero, v.x), hn::Sub(zero, v.y), hn::Sub(zero, v.z)});
}

/// Item `index` of a list of three floats each.
template <class D>
HWY_INLINE Vectors<D> gather(D d, const Vec3f* list, IndexVec<D> index) {
  const auto at = hn::Add(index, hn::Add(index, index));
  const float* base = &list->x;
  return {hn::GatherIndex(d, base, at), hn::GatherIndex(d, base + 1, at),
          hn::GatherIndex(d, base + 2, at)};
}
template <class D>
HWY_INLINE IndexVec<D> gather(D, const std::uint32_t* list, IndexVec<D> index) {
  const hn::RebindToSigned<D> di;
  return hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(list), index);
}

/// Triangles turned towards the eye, one a lane.
template <class D>
struct Facets {
  Vectors<D> weight[3];  ///< of the corners, forms over the image; not negative inside
  Vectors<D> normal[3];  ///< at the corners
  Vectors<D> color[3];   ///< at the corners
  Vectors<D> face;       ///< unit normal
};

/// One triangle as it is kept, so that its other pixels find it: the members of Facets in order.
struct KeptFacet {
  std::uint32_t triangle = kNoHit;
  Vec3f weight[3], normal[3], color[3], face;
};

class FacetMaker {
 public:
  FacetMaker(const PinholeRays& rays, const ShadedMesh& mesh) : rays_(rays), mesh_(mesh) {}

  template <class D>
  HWY_INLINE Facets<D> make(D d, IndexVec<D> triangle) const {
    const auto first = hn::Add(triangle, hn::Add(triangle, triangle));
    const hn::RebindToSigned<D> di;
    Facets<D> out;
    Vectors<D> p[3], n[3];
    const std::uint32_t* corners = mesh_.triangles->v;
    for (int k = 0; k < 3; ++k) {
      const auto v = gather(d, corners, hn::Add(first, hn::Set(di, k)));
      p[k] = difference<D>(gather(d, mesh_.positions, v), broadcast(d, rays_.origin));
      n[k] = gather(d, mesh_.vertex_normals, v);
    }
    const auto face = cross_product<D>(difference<D>(p[1], p[0]), difference<D>(p[2], p[0]));
    const auto is_front = hn::Lt(dot_product<D>(face, p[0]), hn::Zero(d));
    out.face = unit(d, negated_unless(d, is_front, face));
    const auto is_flat = flat(d, triangle);
    for (int k = 0; k < 3; ++k) {
      const Vectors<D>&a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
      const auto edge =
          negated_unless(d, is_front, cross_product<D>(difference<D>(b, a), sum<D>(b, a)));
      out.weight[k] = {dot_product<D>(edge, broadcast(d, rays_.du)),
                       dot_product<D>(edge, broadcast(d, rays_.dv)),
                       dot_product<D>(edge, broadcast(d, rays_.corner))};
      const auto zero = hn::Zero(d);
      const auto none =
          hn::And(hn::Eq(n[k].x, zero), hn::And(hn::Eq(n[k].y, zero), hn::Eq(n[k].z, zero)));
      out.normal[k] = choose<D>(hn::Or(is_flat, none), out.face, negated_unless(d, is_front, n[k]));
    }
    paint(d, triangle, first, out);
    return out;
  }

 private:
  template <class D>
  HWY_INLINE Vectors<D> unit(D d, const Vectors<D>& v) const {
    const auto length = hn::Sqrt(dot_product<D>(v, v));
    return choose<D>(hn::Gt(length, hn::Zero(d)), scaled<D>(v, hn::Div(hn::Set(d, 1.0f), length)),
                     broadcast(d, {0, 0, 1}));
  }

  template <class D>
  HWY_INLINE hn::Mask<D> flat(D d, IndexVec<D> triangle) const {
    const hn::RebindToSigned<D> di;
    alignas(64) std::int32_t number[kTileSide];
    alignas(64) float is_flat[kTileSide];
    hn::Store(triangle, di, number);
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) is_flat[i] = mesh_.is_flat[number[i]];
    return hn::Ne(hn::Load(d, is_flat), hn::Zero(d));
  }

  template <class D>
  HWY_INLINE void paint(D d, IndexVec<D> triangle, IndexVec<D> first, Facets<D>& out) const {
    const hn::RebindToSigned<D> di;
    const auto base = gather(d, mesh_.palette, gather(d, mesh_.palette_index, triangle));
    for (int k = 0; k < 3; ++k) {
      out.color[k] = base;
      if (mesh_.corner_colors == nullptr) continue;
      const auto rgba = gather(d, mesh_.corner_colors, hn::Add(first, hn::Set(di, k)));
      const auto channel = [&](IndexVec<D> bits) {
        const auto byte = hn::And(bits, hn::Set(di, 255));
        return hn::Mul(hn::ConvertTo(d, byte), hn::Set(d, 1.0f / 255.0f));
      };
      out.color[k] = {hn::Mul(base.x, channel(rgba)),
                      hn::Mul(base.y, channel(hn::ShiftRight<8>(rgba))),
                      hn::Mul(base.z, channel(hn::ShiftRight<16>(rgba)))};
    }
  }

  const PinholeRays& rays_;
  const ShadedMesh& mesh_;
};

class TileSurface {
 public:
  TileSurface(const PinholeRays& rays, std::uint32_t x, std::uint32_t y, const ShadedMesh& mesh)
      : rays_(rays), x_(x), y_(y), maker_(rays, mesh) {}

  void run(const TileHits& hits, std::uint32_t rows, SurfaceTile& out) {
    const FloatTag d;
    for (std::uint32_t row = 0; row < rows; ++row)
      for (std::uint32_t column = 0; column < kTileSide; column += hn::Lanes(d)) {
        const std::uint32_t* triangles = hits.triangle + row * kTileSide + column;
        if (runs(triangles) > kFewRuns) {
          shade_each(triangles, row, column, out);
        } else {
          shade_in_turn(triangles, row, column, out);
        }
      }
  }

 private:
  static constexpr std::size_t kKept = 64;
  static constexpr std::size_t kFewRuns = 2;  ///< so many are sooner done in turn

  /// Stretches of the same triangle in a vector of pixels.
  static HWY_INLINE std::size_t runs(const std::uint32_t* triangles) {
    std::size_t count = 1;
    for (std::size_t i = 1; i < hn::Lanes(FloatTag()); ++i)
      count += triangles[i] != triangles[i - 1];
    return count;
  }

  /// A triangle a lane.
  HWY_INLINE void shade_each(const std::uint32_t* triangles, std::uint32_t row,
                             std::uint32_t column, SurfaceTile& out) const {
    const FloatTag d;
    const hn::RebindToUnsigned<FloatTag> du;
    const hn::RebindToSigned<FloatTag> di;
    const auto ids = hn::Load(du, triangles);
    const auto hit = hn::Ne(ids, hn::Set(du, kNoHit));
    const auto safe = hn::BitCast(di, hn::IfThenElseZero(hit, ids));  // triangle 0 where none is
    shade(maker_.make(d, safe), row, column, hn::RebindMask(d, hit), out);
  }

  void shade_in_turn(const std::uint32_t* triangles, std::uint32_t row, std::uint32_t column,
                     SurfaceTile& out) {
    const FloatTag d;
    const hn::RebindToUnsigned<FloatTag> du;
    const auto ids = hn::Load(du, triangles);
    auto pending = hn::Ne(ids, hn::Set(du, kNoHit));
    while (!hn::AllFalse(du, pending)) {
      const std::uint32_t triangle =
          triangles[static_cast<std::size_t>(hn::FindFirstTrue(du, pending))];
      const auto mine = hn::Eq(ids, hn::Set(du, triangle));
      shade(facet_of(triangle), row, column, hn::RebindMask(d, mine), out);
      pending = hn::AndNot(mine, pending);
    }
  }

  /// Neighbouring rows show the same triangles: set up once while it stays kept.
  HWY_INLINE Facets<FloatTag> facet_of(std::uint32_t triangle) {
    KeptFacet& kept = kept_[triangle % kKept];
    if (kept.triangle != triangle) keep(triangle, kept);
    const FloatTag d;
    Facets<FloatTag> out;
    for (int k = 0; k < 3; ++k) {
      out.weight[k] = broadcast(d, kept.weight[k]);
      out.normal[k] = broadcast(d, kept.normal[k]);
      out.color[k] = broadcast(d, kept.color[k]);
    }
    out.face = broadcast(d, kept.face);
    return out;
  }

  void keep(std::uint32_t triangle, KeptFacet& kept) const {
    using One = hn::CappedTag<float, 1>;
    const One one;
    const hn::RebindToSigned<One> one_index;
    const auto facet = maker_.make(one, hn::Set(one_index, static_cast<std::int32_t>(triangle)));
    const auto lane = [](const Vectors<One>& v) {
      return Vec3f{hn::GetLane(v.x), hn::GetLane(v.y), hn::GetLane(v.z)};
    };
    for (int k = 0; k < 3; ++k) {
      kept.weight[k] = lane(facet.weight[k]);
      kept.normal[k] = lane(facet.normal[k]);
      kept.color[k] = lane(facet.color[k]);
    }
    kept.face = lane(facet.face);
    kept.triangle = triangle;
  }

  HWY_INLINE void shade(const Facets<FloatTag>& facet, std::uint32_t row, std::uint32_t column,
                        hn::Mask<FloatTag> mine, SurfaceTile& out) const {
    using V = FloatTag;
    const FloatTag d;
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const auto x = hn::Add(hn::Iota(d, static_cast<float>(x_ + column)), hn::Set(d, 0.5f));
    const float y = static_cast<float>(y_ + row) + 0.5f;
    const auto weight = [&](const Vectors<V>& f) {
      const auto value = hn::Add(hn::Mul(f.x, x), hn::Add(hn::Mul(f.y, hn::Set(d, y)), f.z));
      return hn::Max(value, zero);
    };
    const auto w0 = weight(facet.weight[0]), w1 = weight(facet.weight[1]),
               w2 = weight(facet.weight[2]);
    const auto total = hn::Add(hn::Add(w0, w1), w2);
    const auto share = hn::IfThenElse(hn::Gt(total, zero), hn::Div(one, total), zero);

    // The blend of the corners' normals, on the side of the triangle that is seen.
    Vectors<V> n = sum<V>(sum<V>(scaled<V>(facet.normal[0], w0), scaled<V>(facet.normal[1], w1)),
                          scaled<V>(facet.normal[2], w2));
    const auto square = dot_product<V>(n, n);
    const auto usable = hn::Gt(square, zero);
    const auto size = hn::Div(one, hn::Sqrt(hn::IfThenElse(usable, square, one)));
    const auto turned = hn::CopySign(size, dot_product<V>(n, facet.face));
    n = choose<V>(usable, scaled<V>(n, turned), facet.face);

    const Vec3f base = rays_.corner + rays_.dv * y;
    const Vectors<V> ray = sum<V>(scaled<V>(broadcast(d, rays_.du), x), broadcast(d, base));
    const auto along = hn::Div(dot_product<V>(n, ray), hn::Sqrt(dot_product<V>(ray, ray)));
    const auto facing = hn::Min(hn::Max(hn::Neg(along), zero), one);

    const std::size_t at = row * kTileSide + column;
    const auto put = [&](FloatVec value, float* array) {
      hn::Store(hn::IfThenElse(mine, value, hn::Load(d, array + at)), d, array + at);
    };
    put(n.x, out.normal_x);
    put(n.y, out.normal_y);
    put(n.z, out.normal_z);
    put(facing, out.facing);
    const auto bary1 = hn::Mul(w1, share), bary2 = hn::Mul(w2, share);
    put(bary1, out.bary1);
    put(bary2, out.bary2);
    const auto bary0 = hn::Mul(w0, share);
    const Vectors<V> color =
        sum<V>(sum<V>(scaled<V>(facet.color[0], bary0), scaled<V>(facet.color[1], bary1)),
               scaled<V>(facet.color[2], bary2));
    put(color.x, out.red);
    put(color.y, out.green);
    put(color.z, out.blue);
  }

  const PinholeRays& rays_;
  std::uint32_t x_, y_;
  FacetMaker maker_;
  KeptFacet kept_[kKept];
};

void Surface(const PinholeRays& rays, std::uint32_t x, std::uint32_t y, const ShadedMesh& mesh,
             const TileHits& hits, std::uint32_t rows, SurfaceTile& surface) {
  TileSurface(rays, x, y, mesh).run(hits, rows, surface);
}

}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(Surface);

void compute_surface(const PinholeRays& rays, std::uint32_t x, std::uint32_t y,
                     const ShadedMesh& mesh, const TileHits& hits, std::uint32_t rows,
                     SurfaceTile& surface) {
  HWY_DYNAMIC_DISPATCH(Surface)(rays, x, y, mesh, hits, rows, surface);
}

}  // namespace mdk
#endif  // HWY_ONCE
