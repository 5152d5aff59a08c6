// All rays of a picture leave one eye, so the barycentric coordinates of a ray d are, but for a
// common factor, with corners a, b, c seen from the eye: the weight of c is
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
#include "common/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace surfaces {

static_assert(hn::MaxLanes(FloatTag()) <= kTileSide);

template <class D>
using IndexVec = hn::Vec<hn::RebindToSigned<D>>;

template <class D>
HWY_INLINE Points<D> choose(hn::Mask<D> mask, const Points<D>& yes, const Points<D>& no) {
  return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
          hn::IfThenElse(mask, yes.z, no.z)};
}
/// `v` where not `keep`, else with the sign turned.
template <class D>
HWY_INLINE Points<D> negated_unless(D d, hn::Mask<D> keep, const Points<D>& v) {
  const auto zero = hn::Zero(d);
  return choose(keep, v, {hn::Sub(zero, v.x), hn::Sub(zero, v.y), hn::Sub(zero, v.z)});
}
/// (0, 0, 1) where there is no direction.
template <class D>
HWY_INLINE Points<D> unit(D d, const Points<D>& v) {
  const auto length = hn::Sqrt(dot(v, v));
  return choose(hn::Gt(length, hn::Zero(d)), scaled(v, hn::Div(hn::Set(d, 1.0f), length)),
                broadcast(d, {0, 0, 1}));
}

/// One point per lane, put in whole and taken out as vectors of x, y and z: sooner done than
/// gathering coordinate by coordinate.
template <class D>
class Rows {
 public:
  /// A fourth float is read, too, and ignored.
  HWY_INLINE void put(std::size_t lane, const Vec3f& point) {
    const hn::CappedTag<float, 4> d4;
    float* place = rows_ + lane % kStep * kLanes + lane / kStep * 4;
    for (std::size_t k = 0; k < 4; k += hn::Lanes(d4))
      hn::Store(hn::Load(d4, &point.x + k), d4, place + k);
  }

  HWY_INLINE Points<D> columns() const {
    const D d;
    if constexpr (kStep == 1) {
      return {hn::Load(d, rows_), hn::Load(d, rows_ + 1), hn::Load(d, rows_ + 2)};
    } else {
      // Four lanes a block, turned over block by block. Found by their arguments: a machine without
      // SIMD has no such functions.
      const hn::Repartition<std::uint64_t, D> d64;
      const auto pairs = [&](hn::Vec<D> v) { return hn::BitCast(d64, v); };
      const auto a = hn::Load(d, rows_), b = hn::Load(d, rows_ + kLanes);
      const auto c = hn::Load(d, rows_ + 2 * kLanes), e = hn::Load(d, rows_ + 3 * kLanes);
      const auto xy_ab = pairs(InterleaveLower(d, a, b));
      const auto xy_ce = pairs(InterleaveLower(d, c, e));
      const auto z_ab = pairs(InterleaveUpper(d, a, b));
      const auto z_ce = pairs(InterleaveUpper(d, c, e));
      return {hn::BitCast(d, InterleaveLower(d64, xy_ab, xy_ce)),
              hn::BitCast(d, InterleaveUpper(d64, xy_ab, xy_ce)),
              hn::BitCast(d, InterleaveLower(d64, z_ab, z_ce))};
    }
  }

 private:
  static constexpr std::size_t kLanes = hn::MaxLanes(D());
  static constexpr std::size_t kStep = kLanes < 4 ? 1 : 4;
  static_assert(kLanes == 1 || kLanes % 4 == 0);
  alignas(64) float rows_[4 * kLanes];
};

/// Triangles turned towards the eye, one a lane.
template <class D>
struct Facets {
  Points<D> edge[3];    ///< across from the corners: edge . ray is the corner's weight
  Points<D> normal[3];  ///< at the corners
  Points<D> color[3];   ///< at the corners; without corner colours only the first
  Points<D> face;       ///< their own normal, of any length
};

/// One triangle as it is kept, so that its other pixels find it: the members of Facets in order.
struct KeptFacet {
  std::uint32_t triangle = kNoHit;
  Vec3f edge[3], normal[3], color[3], face;
};

class FacetMaker {
 public:
  FacetMaker(const PinholeRays& rays, const ShadedMesh& mesh) : rays_(rays), mesh_(mesh) {}

  template <class D>
  HWY_INLINE Facets<D> make(D d, const std::uint32_t* triangles) const {
    Facets<D> out;
    Points<D> p[3], n[3];
    fetch_corners(d, triangles, p, n);
    for (Points<D>& corner : p) corner = corner - broadcast(d, rays_.origin);
    out.face = cross(p[1] - p[0], p[2] - p[0]);
    const auto is_front = hn::Lt(dot(out.face, p[0]), hn::Zero(d));
    out.face = negated_unless(d, is_front, out.face);
    const auto is_flat = fetch_flat(d, triangles);
    for (int k = 0; k < 3; ++k) {
      const Points<D>&a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
      out.edge[k] = negated_unless(d, is_front, edge_form(a, b));
      const auto zero = hn::Zero(d);
      const auto none =
          hn::And(hn::Eq(n[k].x, zero), hn::And(hn::Eq(n[k].y, zero), hn::Eq(n[k].z, zero)));
      const auto own = hn::Or(is_flat, none);
      out.normal[k] = negated_unless(d, is_front, n[k]);
      if (!hn::AllFalse(d, own)) out.normal[k] = choose(own, unit(d, out.face), out.normal[k]);
    }
    fetch_colors(d, triangles, out);
    return out;
  }

 private:
  template <class D>
  HWY_INLINE void fetch_corners(D d, const std::uint32_t* triangles, Points<D> (&p)[3],
                                Points<D> (&n)[3]) const {
    Rows<D> position[3], normal[3];
    for (std::size_t i = 0; i < hn::Lanes(d); ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const SurfaceVertex& v = mesh_.vertices[mesh_.triangles[triangles[i]].v[k]];
        position[k].put(i, v.position);
        normal[k].put(i, v.normal);
      }
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = position[k].columns();
      n[k] = normal[k].columns();
    }
  }

  template <class D>
  HWY_INLINE hn::Mask<D> fetch_flat(D d, const std::uint32_t* triangles) const {
    alignas(64) float is_flat[kTileSide];
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) is_flat[i] = mesh_.is_flat[triangles[i]];
    return hn::Ne(hn::Load(d, is_flat), hn::Zero(d));
  }

  template <class D>
  HWY_INLINE void fetch_colors(D d, const std::uint32_t* triangles, Facets<D>& out) const {
    const hn::RebindToSigned<D> di;
    alignas(64) float red[kTileSide], green[kTileSide], blue[kTileSide];
    alignas(64) std::int32_t rgba[3][kTileSide];
    for (std::size_t i = 0; i < hn::Lanes(d); ++i) {
      const Vec3f& base = mesh_.palette[mesh_.palette_index[triangles[i]]];
      red[i] = base.x;
      green[i] = base.y;
      blue[i] = base.z;
    }
    const Points<D> base{hn::Load(d, red), hn::Load(d, green), hn::Load(d, blue)};
    out.color[0] = base;
    if (mesh_.corner_colors == nullptr) return;
    for (std::size_t i = 0; i < hn::Lanes(d); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        rgba[k][i] = static_cast<std::int32_t>(mesh_.corner_colors[3 * triangles[i] + k]);
    for (int k = 0; k < 3; ++k) {
      const auto bits = hn::Load(di, rgba[k]);
      const auto channel = [&](IndexVec<D> shifted) {
        const auto byte = hn::And(shifted, hn::Set(di, 255));
        return hn::Mul(hn::ConvertTo(d, byte), hn::Set(d, 1.0f / 255.0f));
      };
      out.color[k] = {hn::Mul(base.x, channel(bits)),
                      hn::Mul(base.y, channel(hn::ShiftRight<8>(bits))),
                      hn::Mul(base.z, channel(hn::ShiftRight<16>(bits)))};
    }
  }

  const PinholeRays& rays_;
  const ShadedMesh& mesh_;
};

class TileSurface {
 public:
  TileSurface(const PinholeRays& rays, std::uint32_t x, std::uint32_t y, const ShadedMesh& mesh,
              const SurfaceOptions& options)
      : rays_(rays), x_(x), y_(y), maker_(rays, mesh), options_(options) {
    has_colors_ = mesh.corner_colors != nullptr;
  }

  void run(const TileHits& hits, SurfaceTile& out) {
    const FloatTag d;
    for (std::uint32_t row = 0; row < kTileSide; ++row)
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
    const auto ids = hn::Load(du, triangles);
    const auto hit = hn::Ne(ids, hn::Set(du, kNoHit));
    alignas(64) std::uint32_t safe[kTileSide];  // where none is hit, one that is hit nearby
    const auto any = hn::Set(du, triangles[hn::FindFirstTrue(du, hit)]);
    hn::Store(hn::IfThenElse(hit, ids, any), du, safe);
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
      out.edge[k] = broadcast(d, kept.edge[k]);
      out.normal[k] = broadcast(d, kept.normal[k]);
      out.color[k] = broadcast(d, kept.color[k]);
    }
    out.face = broadcast(d, kept.face);
    return out;
  }

  void keep(std::uint32_t triangle, KeptFacet& kept) const {
    using One = hn::CappedTag<float, 1>;
    const auto facet = maker_.make(One(), &triangle);
    const auto lane = [](const Points<One>& v) {
      return Vec3f{hn::GetLane(v.x), hn::GetLane(v.y), hn::GetLane(v.z)};
    };
    for (int k = 0; k < 3; ++k) {
      kept.edge[k] = lane(facet.edge[k]);
      kept.normal[k] = lane(facet.normal[k]);
      if (k == 0 || has_colors_) kept.color[k] = lane(facet.color[k]);
    }
    kept.face = lane(facet.face);
    kept.triangle = triangle;
  }

  /// Where a vector of pixels goes in a tile's arrays.
  class Place {
   public:
    Place(std::uint32_t row, std::uint32_t column, hn::Mask<FloatTag> mine)
        : at_(row * kTileSide + column), mine_(mine) {}
    HWY_INLINE void put(FloatVec value, float* array) const {
      const FloatTag d;
      hn::Store(hn::IfThenElse(mine_, value, hn::Load(d, array + at_)), d, array + at_);
    }
    HWY_INLINE void put(const Points<FloatTag>& value, float* x, float* y, float* z) const {
      put(value.x, x);
      put(value.y, y);
      put(value.z, z);
    }

   private:
    std::size_t at_;
    hn::Mask<FloatTag> mine_;
  };

  HWY_INLINE void shade(const Facets<FloatTag>& facet, std::uint32_t row, std::uint32_t column,
                        hn::Mask<FloatTag> mine, SurfaceTile& out) const {
    const FloatTag d;
    const Place place(row, column, mine);
    const auto x = hn::Add(hn::Iota(d, static_cast<float>(x_ + column)), hn::Set(d, 0.5f));
    const Vec3f base = rays_.corner + rays_.dv * (static_cast<float>(y_ + row) + 0.5f);
    const Points<FloatTag> ray = scaled(broadcast(d, rays_.du), x) + broadcast(d, base);
    FloatVec w[3];
    for (int k = 0; k < 3; ++k) w[k] = hn::Max(dot(facet.edge[k], ray), hn::Zero(d));

    face_the_eye(facet, ray, w, place, out);
    if (has_colors_ || options_.barycentrics) {
      const auto total = hn::Add(hn::Add(w[0], w[1]), w[2]);
      const auto share =
          hn::IfThenElse(hn::Gt(total, hn::Zero(d)), hn::Div(hn::Set(d, 1.0f), total), hn::Zero(d));
      for (FloatVec& weight : w) weight = hn::Mul(weight, share);
    }
    if (options_.barycentrics) {
      place.put(w[1], out.bary1);
      place.put(w[2], out.bary2);
    }
    place.put(has_colors_ ? blend(facet.color, w) : facet.color[0], out.red, out.green, out.blue);
  }

  static HWY_INLINE Points<FloatTag> blend(const Points<FloatTag> (&corner)[3],
                                           const FloatVec (&w)[3]) {
    return scaled(corner[0], w[0]) + scaled(corner[1], w[1]) + scaled(corner[2], w[2]);
  }

  /// The blend of the corners' normals, on the side of the triangle that is seen.
  HWY_INLINE void face_the_eye(const Facets<FloatTag>& facet, const Points<FloatTag>& ray,
                               const FloatVec (&w)[3], const Place& place, SurfaceTile& out) const {
    const FloatTag d;
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    Points<FloatTag> n = blend(facet.normal, w);
    auto square = dot(n, n);
    const auto usable = hn::Gt(square, zero);
    if (!hn::AllTrue(d, usable)) {
      n = choose(usable, n, unit(d, facet.face));
      square = hn::IfThenElse(usable, square, one);
    }
    const auto side = dot(n, facet.face);
    if (options_.facing) {
      const auto along = hn::Mul(dot(n, ray), hn::CopySign(one, side));
      const auto cosine = hn::Div(hn::Neg(along), hn::Sqrt(hn::Mul(square, dot(ray, ray))));
      place.put(hn::Min(hn::Max(cosine, zero), one), out.facing);
    }
    if (options_.normals) {
      const auto size = hn::Div(one, hn::Sqrt(square));
      place.put(scaled(n, hn::CopySign(size, side)), out.normal_x, out.normal_y, out.normal_z);
    }
  }

  const PinholeRays& rays_;
  std::uint32_t x_, y_;
  FacetMaker maker_;
  SurfaceOptions options_;
  bool has_colors_;
  KeptFacet kept_[kKept];
};

void Surface(const PinholeRays& rays, std::uint32_t x, std::uint32_t y, const ShadedMesh& mesh,
             const TileHits& hits, const SurfaceOptions& options, SurfaceTile& surface) {
  TileSurface(rays, x, y, mesh, options).run(hits, surface);
}

}  // namespace surfaces
using surfaces::Surface;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(Surface);

void compute_surface(const PinholeRays& rays, std::uint32_t x, std::uint32_t y,
                     const ShadedMesh& mesh, const TileHits& hits, const SurfaceOptions& options,
                     SurfaceTile& surface) {
  HWY_DYNAMIC_DISPATCH(Surface)(rays, x, y, mesh, hits, options, surface);
}

}  // namespace mdk
#endif  // HWY_ONCE
