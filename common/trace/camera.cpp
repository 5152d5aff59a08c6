#include "common/trace/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "common/base/error.h"

namespace mdk {
namespace {

bool is_finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A unit vector at a right angle to unit `w`, as near to `up` as there is.
Vec3d right_of(const Vec3d& w, const Vec3d& up) {
  const Vec3d right = cross(w, normalized(up, {0, 1, 0}));
  if (length(right) > 1e-6) return normalized(right);
  const Vec3d other = std::abs(w.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1};
  return normalized(cross(w, other));
}

}  // namespace

PinholeRays make_pinhole_rays(const Camera& camera, std::uint32_t width, std::uint32_t height) {
  if (!is_finite(camera.eye) || !is_finite(camera.target) || !is_finite(camera.up))
    throw Error(ErrorCode::kUsage, "the camera's numbers must be finite");
  if (!(camera.vertical_fov_deg > 0 && camera.vertical_fov_deg < 180))
    throw Error(ErrorCode::kUsage,
                "the camera's field of view must lie between 0 and 180 degrees, not " +
                    std::to_string(camera.vertical_fov_deg));
  const Vec3d forward = to_double(camera.target) - to_double(camera.eye);
  if (!(length(forward) > 0))
    throw Error(ErrorCode::kUsage, "the camera's eye and target must not coincide");

  const Vec3d w = normalized(forward);
  const Vec3d right = right_of(w, to_double(camera.up));
  const Vec3d down = cross(w, right);
  const double half_height =
      std::tan(static_cast<double>(camera.vertical_fov_deg) * std::numbers::pi / 360);
  const double pixel = 2 * half_height / height;
  const Vec3d corner = w - right * (0.5 * pixel * width) - down * half_height;
  return {camera.eye, to_float(corner), to_float(right * pixel), to_float(down * pixel)};
}

Camera fit_camera(const Aabb& bounds, double aspect) {
  constexpr double kFovDeg = 40;
  const Aabb box = bounds.empty() ? Aabb{{-1, -1, -1}, {1, 1, 1}} : bounds;
  const Vec3d center = to_double(box.center());
  const Vec3d back = normalized(Vec3d{0.45, 0.3, 1.0});
  const Vec3d right = normalized(cross(Vec3d{0, 1, 0}, back));
  const Vec3d up = cross(back, right);
  const double tan_y = std::tan(kFovDeg * std::numbers::pi / 360);
  const double tan_x = tan_y * aspect;

  double distance = 0;  // so that every corner of the box is inside the frustum
  for (int i = 0; i < 8; ++i) {
    const Vec3d corner{i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y,
                       i & 4 ? box.hi.z : box.lo.z};
    const Vec3d d = corner - center;
    distance = std::max({distance, dot(d, back) + std::abs(dot(d, right)) / tan_x,
                         dot(d, back) + std::abs(dot(d, up)) / tan_y});
  }
  const double margin = 1.04;
  Camera camera;
  camera.target = to_float(center);
  camera.eye = to_float(center + back * (distance > 0 ? distance * margin : 1.0));
  camera.vertical_fov_deg = kFovDeg;
  return camera;
}

}  // namespace mdk
