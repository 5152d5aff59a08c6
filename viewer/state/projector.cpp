#include "viewer/state/projector.h"

namespace mdk {
namespace {

constexpr double kNearPart = 1e-3;  // of the distance to what is looked at

}  // namespace

// A ray is t (corner + x du + y dv): a world offset d from the eye is [corner du dv] (t, tx, ty),
// so its rows are those of the inverse of that matrix. Pictures of one shape share these rays,
// whatever their size: one of unit pixels will do, scaled to the place.
Projector::Projector(const Camera& camera, const Rect& place)
    : place_(place), eye_(to_double(camera.eye)) {
  constexpr std::uint32_t kHeight = 4096;
  const double aspect = static_cast<double>(place.width) / static_cast<double>(place.height);
  const auto width = static_cast<std::uint32_t>(aspect * kHeight + 0.5);
  const PinholeRays rays = make_pinhole_rays(camera, width > 0 ? width : 1, kHeight);
  const Vec3d corner = to_double(rays.corner);
  const Vec3d du = to_double(rays.du) * static_cast<double>(width > 0 ? width : 1);
  const Vec3d dv = to_double(rays.dv) * static_cast<double>(kHeight);
  const double scale = 1 / dot(cross(corner, du), dv);
  rows_ = {cross(du, dv) * scale, cross(dv, corner) * scale, cross(corner, du) * scale};
  near_ = kNearPart * length(to_double(camera.target) - eye_);
}

Vec3d Projector::view(const Vec3d& world) const {
  const Vec3d offset = world - eye_;
  return {dot(rows_[0], offset), dot(rows_[1], offset), dot(rows_[2], offset)};
}

std::optional<Projector::Segment> Projector::project(const Vec3d& from, const Vec3d& to) const {
  Vec3d a = view(from), b = view(to);
  if (!(a.x >= near_) && !(b.x >= near_)) return {};
  const auto clip = [this](const Vec3d& behind, const Vec3d& front) {
    return behind + (front - behind) * ((near_ - behind.x) / (front.x - behind.x));
  };
  if (a.x < near_) a = clip(a, b);
  if (b.x < near_) b = clip(b, a);
  const auto point = [this](const Vec3d& v) {
    return Point{place_.x + place_.width * static_cast<float>(v.y / v.x),
                 place_.y + place_.height * static_cast<float>(v.z / v.x)};
  };
  return Segment{point(a), point(b)};
}

}  // namespace mdk
