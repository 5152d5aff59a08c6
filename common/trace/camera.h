// Camera: a pinhole, the rays it sends through pixel centres, and how samples spread around those.
#pragma once

#include <cmath>
#include <cstdint>

#include "common/math/aabb.h"
#include "common/math/vec3.h"

namespace mdk {

struct Camera {
  Vec3f eye{0, 0, 1};
  Vec3f target{0, 0, 0};
  Vec3f up{0, 1, 0};
  float vertical_fov_deg = 45;  ///< in (0, 180)

  bool operator==(const Camera&) const = default;
};

/// The ray through image point (x, y), in pixels from the upper left corner, is
/// origin + t (corner + x du + y dv); pixel (i, j) has its centre at (i + 0.5, j + 0.5). Directions
/// are not normalised: their component along the view axis is 1, so t is the depth along that axis.
struct PinholeRays {
  Vec3f origin, corner, du, dv;

  Vec3f direction(float x, float y) const { return corner + du * x + dv * y; }
};

/// Largest image side in pixels.
inline constexpr std::uint32_t kMaxImageSide = 16384;

/// Throws Error (kUsage) where the camera sees nothing: eye and target coincide, numbers that are
/// not finite, a field of view outside (0, 180). An `up` along the view axis is replaced.
PinholeRays make_pinhole_rays(const Camera& camera, std::uint32_t width, std::uint32_t height);

/// Point `i` of a sequence that covers the unit square evenly (Roberts 2018); the first one is its
/// middle.
struct EvenPoint {
  double x, y;

  explicit EvenPoint(std::uint32_t i)
      : x(fraction(0.5 + i * 0.7548776662466927)), y(fraction(0.5 + i * 0.5698402909980532)) {}
  static double fraction(double a) { return a - std::floor(a); }
};

/// A camera in front of `bounds` (from +z, slightly above and to the side) so that all of it is in
/// the picture.
Camera fit_camera(const Aabb& bounds, double aspect);

}  // namespace mdk
