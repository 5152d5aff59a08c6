// FrameStats: what one frame cost, in time and in work.
#pragma once

#include <cstdint>

namespace mdk {

/// Work of tracing, summed over a frame. A tile of rays that shares one frustum counts a node once:
/// per-ray figures are amortised, as in GFW06 Table 1. A triangle in
/// several leaves counts once for a tile: it is looked at once.
struct TraceCounters {
  std::uint64_t node_visits = 0;     ///< kd traversal steps or boxes tested, once per tile
  std::uint64_t leaf_triangles = 0;  ///< tile-triangle pairs in leaves entered, before any culling
  std::uint64_t triangle_tests = 0;  ///< ray-triangle pairs evaluated, after culling
  std::uint64_t clusters_entered = 0;  ///< tile-cluster pairs whose local box was entered

  TraceCounters& operator+=(const TraceCounters& b) {
    node_visits += b.node_visits;
    leaf_triangles += b.leaf_triangles;
    triangle_tests += b.triangle_tests;
    clusters_entered += b.clusters_entered;
    return *this;
  }
  bool operator==(const TraceCounters&) const = default;
};

struct FrameStats {
  double pose_ms = 0;    ///< vertices at t
  double update_ms = 0;  ///< making the acceleration structure valid for this frame
  double trace_ms = 0;   ///< finding the closest hits
  double shade_ms = 0;
  double prebuild_ms = 0;  ///< work a technique does ahead of time; not part of the frame
  std::uint64_t rays = 0;
  std::uint64_t hits = 0;
  std::uint64_t light_rays = 0;  ///< to lights and sky; their time is part of shade_ms
  TraceCounters counters;        ///< all zero unless counting was asked for

  double time_to_image_ms() const { return pose_ms + update_ms + trace_ms + shade_ms; }
};

}  // namespace mdk
