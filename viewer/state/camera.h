// Camera: how drags and wheel steps move it, and where it sees a point of the world.
#pragma once

#include <array>
#include <optional>

#include "common/math/aabb.h"
#include "common/math/vec3.h"
#include "common/trace/camera.h"
#include "viewer/state/layout.h"

namespace mdk {

/// A place or a step in the picture, in picture heights: x to the right, y downwards.
struct PictureOffset {
  double x = 0, y = 0;
};

/// Turns drags and wheel steps into cameras. It keeps what is looked at (the target), a distance,
/// and two angles about an upright axis, so that no sequence of motions can roll, flip over a pole,
/// reach the target or produce a number that is not finite.
///
///      axis (up)
///        |    eye        eye = target + distance *
///        |   /                 (cos pitch (cos yaw X + sin yaw Z) + sin pitch axis)
///        |  / pitch
///        | /_____ X
///      target
class OrbitCamera {
 public:
  /// Shows exactly `camera` until the first motion; its `up` becomes the upright axis. The diagonal
  /// and centre of `scene` bound how near, how far and how far off one can go.
  void set(const Camera& camera, const Aabb& scene);

  /// Turns about the target; a drag of one picture height is half a turn. Stops short of the poles.
  void orbit(const PictureOffset& drag);

  /// Moves eye and target so that what lies in the target's plane follows the pointer.
  void pan(const PictureOffset& drag);

  /// Wheel steps (positive: nearer), each a tenth of the way; what lies in the target's plane under
  /// `pointer` (from the picture's centre) stays under it.
  void zoom(double steps, const PictureOffset& pointer);

  /// Keeps the direction of view and puts all of `bounds` into a picture of width / height
  /// `aspect`.
  void fit(const Aabb& bounds, double aspect);

  const Camera& camera() const { return camera_; }

 private:
  struct Basis {
    Vec3d right, up, back;  ///< of the view, orthonormal; `back` points from target to eye
  };
  Basis view_basis() const;
  double plane_height() const;  ///< world height of the picture in the target's plane
  void move_target(const Vec3d& to);
  void set_distance(double distance);
  void update_camera();

  Camera camera_;
  Vec3d axis_{0, 1, 0}, x_axis_{0, 0, 1}, z_axis_{1, 0, 0};
  Vec3d target_{0, 0, 0}, scene_center_{0, 0, 0};
  double yaw_ = 0, pitch_ = 0, distance_ = 1, scene_diagonal_ = 1;
};

/// Where points of the world lie in the window's picture.
class Projector {
 public:
  /// For a picture of the camera's view that fills `place`.
  Projector(const Camera& camera, const Rect& place);

  struct Point {
    float x = 0, y = 0;  ///< in window coordinates; outside `place` where it is not seen
  };
  struct Segment {
    Point from, to;
  };

  /// The part of the segment in front of the eye; empty where there is none.
  std::optional<Segment> project(const Vec3d& from, const Vec3d& to) const;

 private:
  /// Depth along the view axis, and picture x and y times depth.
  Vec3d view(const Vec3d& world) const;

  Rect place_;
  Vec3d eye_;
  std::array<Vec3d, 3> rows_;  ///< of the map from world offsets to view()
  double near_ = 0;
};

}  // namespace mdk
