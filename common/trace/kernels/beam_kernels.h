// RayBeam: parallel rays without end, as shadows of a distant light and a sky ask for them, and
// which of them hit the mesh. Seen along their direction each ray is a point, so all of them share
// every projection of a triangle (docs/lighting.md).
//
//        w, the rays' direction          u, v: across; a ray is a point (u, v) and the
//          ^   ^    ^  ^                       depth w it starts at
//          |   |    |  |
//        --o---o----o--o--> u, v
#pragma once

#include <cmath>
#include <cstdint>

#include "common/math/vec3.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/tile_kernels.h"

namespace mdk {

/// A right-angled basis about a point of the world: (u, v, w) of p are the dot products of the
/// axes, which are of one length, with p - origin.
struct BeamBasis {
  Vec3f axis[3];  ///< across, across, along
  Vec3f origin;
};

/// A basis whose axes have the length `scale`, w along `direction`, a unit vector (Duff et al.
/// 2017).
inline BeamBasis make_beam_basis(const Vec3f& direction, const Vec3f& origin, float scale) {
  const Vec3f& n = direction;
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1 / (sign + n.z), b = n.x * n.y * a;
  const Vec3f u{1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
  const Vec3f v{b, sign + n.y * n.y * a, -n.y};
  return {{u * scale, v * scale, n * scale}, origin};
}

/// As many rays as are tested together.
inline constexpr std::uint32_t kBeamGroup = 16;
inline constexpr std::uint32_t kBeamGroups = kTilePixels / kBeamGroup;

struct alignas(64) RayBeam {
  BeamBasis basis;
  std::uint32_t count = 0;           ///< of rays, at most kTilePixels
  alignas(64) float u[kTilePixels];  ///< where each ray starts
  alignas(64) float v[kTilePixels];
  alignas(64) float w[kTilePixels];
  std::uint16_t occluded[kBeamGroups];  ///< a bit per ray, rays of a group in order: the answer

  void clear(const BeamBasis& b) {
    basis = b;
    count = 0;
    for (std::uint16_t& bits : occluded) bits = 0;
  }
  /// A ray from `p`, given relative to the basis's origin.
  void push(const Vec3f& p) {
    u[count] = dot(basis.axis[0], p);
    v[count] = dot(basis.axis[1], p);
    w[count] = dot(basis.axis[2], p);
    ++count;
  }
  bool is_occluded(std::uint32_t ray) const {
    return (occluded[ray / kBeamGroup] >> (ray % kBeamGroup) & 1u) != 0;
  }
};

/// Marks the rays that hit the scene. The same rays with every structure and on every machine, to
/// the bit. All of the mesh must be posed.
void occlude_beam(const TraceScene& scene, RayBeam& beam, TileScratch& scratch);

}  // namespace mdk
