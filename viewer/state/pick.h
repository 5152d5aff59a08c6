// Pick: the triangle under a pixel, and how it moves against its cluster.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/trace/camera.h"
#include "viewer/state/pose.h"

namespace mdk {

struct PickedTriangle {
  std::uint32_t triangle = 0, cluster = 0;
  float depth = 0;  ///< along the view axis, in world units

  bool operator==(const PickedTriangle&) const = default;
};

/// A picture's rays.
struct PictureRays {
  Camera camera;
  std::uint32_t width = 0, height = 0;
};

/// What pixel (x, y) of the picture shows: the closest hit of one ray through its centre, found
/// without any structure. Empty for the background. Cost: O(vertices + triangles).
std::optional<PickedTriangle> pick_triangle(const ModelView& model, const Moment& moment,
                                            const PictureRays& picture, std::uint32_t x,
                                            std::uint32_t y);

/// Cost: O(log clusters).
std::uint32_t cluster_of_triangle(const ModelView& model, std::uint32_t triangle);

/// One per key of a clip.
struct ResidualCurve {
  std::vector<double> seconds;    ///< from the clip's start
  std::vector<double> residuals;  ///< relative to the rest pose's diagonal
};

/// The largest residual of the triangle's corners at each key of a clip: the distance, in the
/// cluster's basis, of a corner from where it is in the rest pose (GFW06 §3.1; as
/// triangle_residuals()). Cost: O(keys), decoding three vertices for each.
ResidualCurve residual_curve(const ModelView& model, std::uint32_t clip, std::uint32_t triangle);

/// The last curve that was asked for, so that drawing it again costs nothing. For one model.
class ResidualCurveCache {
 public:
  const ResidualCurve& curve(const ModelView& model, std::uint32_t clip, std::uint32_t triangle);

 private:
  std::uint32_t clip_ = 0, triangle_ = 0;
  ResidualCurve curve_;  ///< empty: none was asked for
};

}  // namespace mdk
