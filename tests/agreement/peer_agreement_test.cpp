// Peers have a triangle test of their own: they see what brute force sees, but where a ray passes
// an edge so closely that rounding decides which side it is on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <limits>
#include <sstream>
#include <string>

#include "common/base/isa.h"
#include "common/trace/renderer.h"
#include "formats/mdk/mdk_file.h"
#include "preprocess/pipeline.h"
#include "tests/agreement/test_scenes.h"

namespace mdk {
namespace {

/// In pixels; coordinates of pictures this size round to less than a tenth of it.
constexpr double kOnEdge = 1e-3;

struct ImagePoint {
  double x, y;
};

/// Where the pinhole shows world points, in double.
class Projection {
 public:
  explicit Projection(const PinholeRays& rays)
      : origin_(to_double(rays.origin)),
        corner_(to_double(rays.corner)),
        du_(to_double(rays.du)),
        dv_(to_double(rays.dv)) {}

  ImagePoint operator()(const Vec3f& world) const {
    const Vec3d v = to_double(world) - origin_;
    const double z = dot(v, cross(du_, dv_));
    return {dot(v, cross(dv_, corner_)) / z, dot(v, cross(corner_, du_)) / z};
  }

 private:
  Vec3d origin_, corner_, du_, dv_;
};

/// From a point to the nearest edge of a triangle.
double edge_distance(const ImagePoint& p, const ImagePoint (&corner)[3]) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const ImagePoint &a = corner[k], &b = corner[(k + 1) % 3];
    const double ex = b.x - a.x, ey = b.y - a.y, length = ex * ex + ey * ey;
    const double along = length > 0 ? ((p.x - a.x) * ex + (p.y - a.y) * ey) / length : 0;
    const double s = std::clamp(along, 0.0, 1.0);
    least = std::min(least, std::hypot(p.x - a.x - s * ex, p.y - a.y - s * ey));
  }
  return least;
}

/// Compares two pictures of the same request pixel by pixel.
class PeerComparison {
 public:
  PeerComparison(const ModelView& model, const FrameRequest& request)
      : model_(model),
        mesh_(model),
        projection_(make_pinhole_rays(request.camera, request.width, request.height)) {
    mesh_.set_time(request.at);
  }

  /// Pixels with another triangle at another depth that are not on an edge of either triangle.
  int unexplained(const HitBuffer& ours, const HitBuffer& theirs) {
    int count = 0;
    for (std::uint32_t y = 0; y < ours.height(); ++y)
      for (std::uint32_t x = 0; x < ours.width(); ++x) {
        const std::uint32_t a = ours.triangle(x, y), b = theirs.triangle(x, y);
        if (a == b) continue;
        const float ta = ours.t(x, y), tb = theirs.t(x, y);
        if (a != kNoHit && b != kNoHit && std::abs(ta - tb) <= 1e-5f * std::max(ta, tb)) continue;
        ++different_;
        const ImagePoint p{x + 0.5, y + 0.5};
        if (std::min(distance(p, a), distance(p, b)) > kOnEdge) ++count;
      }
    return count;
  }
  int different() const { return different_; }

 private:
  double distance(const ImagePoint& p, std::uint32_t triangle) const {
    if (triangle == kNoHit) return std::numeric_limits<double>::infinity();
    const std::uint32_t* v = model_.triangles[triangle].v;
    return edge_distance(
        p, {projection_(mesh_.positions()[v[0]]), projection_(mesh_.positions()[v[1]]),
            projection_(mesh_.positions()[v[2]])});
  }

  const ModelView& model_;
  PosedMesh mesh_;
  Projection projection_;
  int different_ = 0;
};

/// Five moments of 600 x 400 pixels, by each instruction set and peer.
void expect_edges_only(const ModelView& model, const std::string& name) {
  constexpr int kMoments = 5, kMaxDifferent = 10;
  Renderer ours(model, "fuzzy-bvh");  // brute force's hits, as all of agreement_test says
  for (const TechniqueInfo& technique : technique_table()) {
    if (technique.kind != TechniqueKind::kPeer) continue;
    for (const std::string_view isa : available_isas()) {
      limit_isa(isa);
      Renderer peer(model, technique.id);
      int different = 0;
      for (int i = 0; i < kMoments; ++i) {
        FrameRequest request;
        request.at = locate_time(model, 0, 0.237 * i * model.clip_seconds(model.clips[0]));
        request.camera = fit_camera(model.bounds, 1.5);
        request.width = 600;
        request.height = 400;
        ours.trace(request);
        peer.trace(request);
        PeerComparison comparison(model, request);
        EXPECT_EQ(comparison.unexplained(ours.hits(), peer.hits()), 0)
            << name << ", " << technique.id << ", " << isa << ", moment " << i;
        different += comparison.different();
      }
      EXPECT_LE(different, kMaxDifferent) << name << ", " << technique.id << ", " << isa;
      if (different > 0)
        std::cout << name << ", " << technique.id << ", " << isa << ": " << different
                  << " of 1,200,000 pixels differ\n";
    }
    reset_isa();
  }
}

TEST(PeerAgreement, WhatPeersSeeDiffersOnlyWhereARayPassesAnEdgeWithinRounding) {
  SilentProgress silent;
  const test::NamedSequence scenes[] = {{"tube", test::bending_tube(60, 32, 8)},
                                        {"sphere", test::twisting_sphere(4, 8)}};
  for (const auto& [name, sequence] : scenes) {
    const DecomposeResult baked = decompose(sequence, {}, silent);
    expect_edges_only(baked.model.view(), name);
  }
}

TEST(PeerAgreement, HoldsOnFiles) {
  const char* files = std::getenv("MDK_AGREEMENT_FILES");
  if (files == nullptr) GTEST_SKIP() << "MDK_AGREEMENT_FILES names no files (a.mdk:b.mdk)";
  std::istringstream list(files);
  for (std::string path; std::getline(list, path, ':');) {
    const MdkFile file(path);
    expect_edges_only(file.model(), path);
  }
}

}  // namespace
}  // namespace mdk
