#include "viewer/state/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mdk {
namespace {

constexpr double kMaxPitch = 0.495 * std::numbers::pi;  // just short of the pole
constexpr double kZoomPerStep = 0.9;
constexpr double kMaxStepsAtOnce = 50;
constexpr double kNearest = 1e-3, kFarthest = 1e3, kFarthestTarget = 1e2;  // in scene diagonals
// Eye and target are stored as floats: nearer than this, relative to where they are, they may
// be the same.
constexpr double kNearestRelativeToPlace = 1e-4;
constexpr double kNearPart =
    1e-3;  // of the distance to what is looked at: the projector's near plane

bool is_finite(const PictureOffset& p) { return std::isfinite(p.x) && std::isfinite(p.y); }
bool is_finite(const Vec3d& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}
double largest(const Vec3d& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// Some unit vector across `axis`: for +y it is +z, where fit_camera() looks from.
Vec3d across(const Vec3d& axis) {
  const Vec3d candidate = std::abs(axis.z) < 0.8 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
  return normalized(candidate - axis * dot(candidate, axis));
}

}  // namespace

void OrbitCamera::set(const Camera& camera, const Aabb& scene) {
  camera_ = camera;
  scene_center_ = scene.empty() ? Vec3d{} : to_double(scene.center());
  const double diagonal = scene.empty() ? 0 : length(to_double(scene.extent()));
  scene_diagonal_ = std::isfinite(diagonal) && diagonal > 0 ? diagonal : 1;

  axis_ = normalized(to_double(camera.up), Vec3d{0, 1, 0});
  x_axis_ = across(axis_);
  z_axis_ = cross(axis_, x_axis_);
  target_ = to_double(camera.target);
  const Vec3d back = to_double(camera.eye) - target_;
  distance_ = length(back);
  const Vec3d direction = normalized(back, x_axis_);
  pitch_ = std::asin(std::clamp(dot(direction, axis_), -1.0, 1.0));
  yaw_ = std::atan2(dot(direction, z_axis_), dot(direction, x_axis_));
}

void OrbitCamera::orbit(const PictureOffset& drag) {
  if (!is_finite(drag)) return;
  yaw_ = std::remainder(yaw_ - drag.x * std::numbers::pi, 2 * std::numbers::pi);
  pitch_ += drag.y * std::numbers::pi;
  update_camera();
}

void OrbitCamera::pan(const PictureOffset& drag) {
  if (!is_finite(drag)) return;
  const Basis view = view_basis();
  const double height = plane_height();
  move_target(target_ - view.right * (drag.x * height) + view.up * (drag.y * height));
  update_camera();
}

void OrbitCamera::zoom(double steps, const PictureOffset& pointer) {
  if (!std::isfinite(steps) || !is_finite(pointer)) return;
  steps = std::clamp(steps, -kMaxStepsAtOnce, kMaxStepsAtOnce);
  const Basis view = view_basis();
  const double height = plane_height(), old_distance = distance_;
  set_distance(distance_ * std::pow(kZoomPerStep, steps));
  // The plane under the pointer shrinks towards it by what the distance really did.
  const double moved = 1 - distance_ / old_distance;
  move_target(target_ + (view.right * pointer.x - view.up * pointer.y) * (height * moved));
  update_camera();
}

void OrbitCamera::fit(const Aabb& bounds, double aspect) {
  if (bounds.empty() || !(aspect > 0) || !std::isfinite(aspect)) return;
  const double half_fov = 0.5 * camera_.vertical_fov_deg * std::numbers::pi / 180;
  const double narrow_half_fov = std::atan(std::tan(half_fov) * std::min(1.0, aspect));
  const double radius = 0.5 * length(to_double(bounds.extent()));
  move_target(to_double(bounds.center()));
  set_distance(radius / std::sin(narrow_half_fov));
  update_camera();
}

OrbitCamera::Basis OrbitCamera::view_basis() const {
  const Vec3d flat = x_axis_ * std::cos(yaw_) + z_axis_ * std::sin(yaw_);
  const Vec3d back = flat * std::cos(pitch_) + axis_ * std::sin(pitch_);
  const Vec3d right = normalized(cross(axis_, flat));
  return {right, cross(back, right), back};
}

double OrbitCamera::plane_height() const {
  return 2 * distance_ * std::tan(0.5 * camera_.vertical_fov_deg * std::numbers::pi / 180);
}

void OrbitCamera::move_target(const Vec3d& to) {
  if (!is_finite(to)) return;
  const Vec3d off = to - scene_center_;
  const double limit = kFarthestTarget * scene_diagonal_, far = length(off);
  target_ = far > limit ? scene_center_ + off * (limit / far) : to;
}

void OrbitCamera::set_distance(double distance) {
  const double nearest =
      std::max(kNearest * scene_diagonal_,
               kNearestRelativeToPlace * std::max(largest(target_), largest(scene_center_)));
  const double farthest = std::max(kFarthest * scene_diagonal_, nearest);
  if (std::isfinite(distance)) distance_ = std::clamp(distance, nearest, farthest);
}

void OrbitCamera::update_camera() {
  pitch_ = std::clamp(pitch_, -kMaxPitch, kMaxPitch);
  set_distance(distance_);
  camera_.target = to_float(target_);
  camera_.eye = to_float(target_ + view_basis().back * distance_);
  camera_.up = to_float(axis_);
}

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
