// Projector: where points of the world lie in the window's picture.
#pragma once

#include <array>
#include <optional>

#include "common/trace/camera.h"
#include "viewer/state/widget_map.h"

namespace mdk {

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
