// All rays of a picture leave one eye, so barycentric coordinates are linear over the image but for
// a common factor: with corners a, b, c seen from the eye, the weight of c at the ray d is
//
//     ((b - a) x (b + a)) . d,    d = corner + X du + Y dv
//
// A triangle's three forms and three normals are set up once and serve all its pixels in the tile;
// lanes of a vector that show the same triangle are worked together.
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

/// value at (X, Y) = x X + (y Y + z)
struct ImageForm {
  float x, y, z;
};

/// One triangle, turned towards the eye.
struct Facet {
  std::uint32_t triangle = kNoHit;
  ImageForm weight[3];  ///< of the corners; not negative inside
  Vec3f normal[3];      ///< at the corners
  Vec3f face_normal;
  Vec3f color[3];  ///< at the corners
};

Vec3f unpack_linear(std::uint32_t rgba) {
  const auto channel = [rgba](int shift) {
    return static_cast<float>(rgba >> shift & 255u) * (1.0f / 255.0f);
  };
  return {channel(0), channel(8), channel(16)};
}

struct Vectors {
  FloatVec x, y, z;
};

HWY_INLINE Vectors scaled(const Vec3f& v, FloatVec s) {
  const FloatTag d;
  return {hn::Mul(hn::Set(d, v.x), s), hn::Mul(hn::Set(d, v.y), s), hn::Mul(hn::Set(d, v.z), s)};
}
HWY_INLINE Vectors sum(const Vectors& a, const Vectors& b) {
  return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE FloatVec dot_product(const Vectors& a, const Vectors& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

class TileSurface {
 public:
  TileSurface(const PinholeRays& rays, std::uint32_t x, std::uint32_t y, const ShadedMesh& mesh)
      : rays_(rays), x_(x), y_(y), mesh_(mesh) {}

  void run(const TileHits& hits, std::uint32_t rows, SurfaceTile& out) {
    const FloatTag d;
    const hn::RebindToUnsigned<FloatTag> du;
    for (std::uint32_t row = 0; row < rows; ++row)
      for (std::uint32_t column = 0; column < kTileSide; column += hn::Lanes(d)) {
        const std::uint32_t first = row * kTileSide + column;
        const auto ids = hn::Load(du, hits.triangle + first);
        auto pending = hn::Ne(ids, hn::Set(du, kNoHit));
        while (!hn::AllFalse(du, pending)) {
          const auto lane = static_cast<std::uint32_t>(hn::FindFirstTrue(du, pending));
          const std::uint32_t triangle = hits.triangle[first + lane];
          const auto mine = hn::Eq(ids, hn::Set(du, triangle));
          shade(facet_of(triangle), row, column, hn::RebindMask(d, mine), out);
          pending = hn::AndNot(mine, pending);
        }
      }
  }

 private:
  static constexpr std::size_t kCacheSize = 64;

  /// Neighbouring rows show the same triangles: set up once while it stays in the cache.
  const Facet& facet_of(std::uint32_t triangle) {
    Facet& facet = cache_[triangle % kCacheSize];
    if (facet.triangle != triangle) set_up(triangle, facet);
    return facet;
  }

  void set_up(std::uint32_t triangle, Facet& facet) const {
    const std::uint32_t* v = mesh_.triangles[triangle].v;
    Vec3f p[3];
    for (int k = 0; k < 3; ++k) p[k] = mesh_.positions[v[k]] - rays_.origin;
    Vec3f face = cross(p[1] - p[0], p[2] - p[0]);
    const bool is_front = dot(face, p[0]) < 0;
    face = normalized(is_front ? face : -face);
    for (int k = 0; k < 3; ++k) {
      const Vec3f& a = p[(k + 1) % 3];
      const Vec3f& b = p[(k + 2) % 3];
      const Vec3f edge = is_front ? cross(b - a, b + a) : cross(b + a, b - a);
      facet.weight[k] = {dot(edge, rays_.du), dot(edge, rays_.dv), dot(edge, rays_.corner)};
      const Vec3f& n = mesh_.vertex_normals[v[k]];
      const bool is_flat = mesh_.is_flat[triangle] != 0 || n == Vec3f{};
      facet.normal[k] = is_flat ? face : is_front ? n : -n;
    }
    const Vec3f& paint = mesh_.palette[mesh_.palette_index[triangle]];
    for (std::uint32_t k = 0; k < 3; ++k) {
      facet.color[k] = paint;
      if (mesh_.corner_colors == nullptr) continue;
      const Vec3f corner = unpack_linear(mesh_.corner_colors[std::size_t{3} * triangle + k]);
      facet.color[k] = {paint.x * corner.x, paint.y * corner.y, paint.z * corner.z};
    }
    facet.face_normal = face;
    facet.triangle = triangle;
  }

  HWY_INLINE void shade(const Facet& facet, std::uint32_t row, std::uint32_t column,
                        hn::Mask<FloatTag> mine, SurfaceTile& out) const {
    const FloatTag d;
    const auto zero = hn::Zero(d), one = hn::Set(d, 1.0f);
    const auto x = hn::Add(hn::Iota(d, static_cast<float>(x_ + column)), hn::Set(d, 0.5f));
    const float y = static_cast<float>(y_ + row) + 0.5f;
    const auto weight = [&](const ImageForm& f) {
      const auto value = hn::Add(hn::Mul(hn::Set(d, f.x), x), hn::Set(d, f.y * y + f.z));
      return hn::Max(value, zero);
    };
    const auto w0 = weight(facet.weight[0]), w1 = weight(facet.weight[1]),
               w2 = weight(facet.weight[2]);
    const auto total = hn::Add(hn::Add(w0, w1), w2);
    const auto share = hn::IfThenElse(hn::Gt(total, zero), hn::Div(one, total), zero);

    // The blend of the corners' normals, on the side of the triangle that is seen.
    Vectors n = sum(sum(scaled(facet.normal[0], w0), scaled(facet.normal[1], w1)),
                    scaled(facet.normal[2], w2));
    const Vectors face = scaled(facet.face_normal, one);
    const auto square = dot_product(n, n);
    const auto usable = hn::Gt(square, zero);
    const auto size = hn::Div(one, hn::Sqrt(hn::IfThenElse(usable, square, one)));
    const auto turned = hn::CopySign(size, dot_product(n, face));
    n = {hn::IfThenElse(usable, hn::Mul(n.x, turned), face.x),
         hn::IfThenElse(usable, hn::Mul(n.y, turned), face.y),
         hn::IfThenElse(usable, hn::Mul(n.z, turned), face.z)};

    const Vec3f base = rays_.corner + rays_.dv * y;
    const Vectors ray = sum(scaled(rays_.du, x), scaled(base, one));
    const auto along = hn::Div(dot_product(n, ray), hn::Sqrt(dot_product(ray, ray)));
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
    const Vectors color = sum(sum(scaled(facet.color[0], bary0), scaled(facet.color[1], bary1)),
                              scaled(facet.color[2], bary2));
    put(color.x, out.red);
    put(color.y, out.green);
    put(color.z, out.blue);
  }

  const PinholeRays& rays_;
  std::uint32_t x_, y_;
  const ShadedMesh& mesh_;
  Facet cache_[kCacheSize];
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
