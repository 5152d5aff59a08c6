// Clusters by the cost of their boxes, on meshes small and large.
#include <gtest/gtest.h>

#include <algorithm>

#include "preprocess/cluster/clusters.h"
#include "preprocess/pose/pose_table.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

Growth grown(const PoseSequence& sequence, const ClusterRequest& request) {
  SilentProgress silent;
  const Growth growth = cluster_by_boxes(sequence, request, pose_unit(sequence), silent);
  validate(growth, sequence.triangles.size());
  return growth;
}

/// A sheet whose halves turn against each other.
PoseSequence folding_sheet(std::uint32_t quads) {
  const Mesh mesh = curved_sheet(quads);
  return make_sequence(mesh, 4, [&](std::uint32_t k, std::uint32_t i) {
    const Vec3d v = mesh.vertices[i];
    const double angle = v.x > 0.5 ? 0.3 * k : -0.3 * k;
    return rigid_motion({0, 1, 0}, angle, {0.5, 0, 0}).point(v - Vec3d{0.5, 0, 0});
  });
}

TEST(BoxGrowth, AThinnedMeshGivesTheClustersOfTheWhole) {
  const PoseSequence sequence = folding_sheet(112);  // 25,088 triangles
  const Growth growth = grown(sequence, {.clusters = 2});
  ASSERT_EQ(growth.cluster_count, 2u);
  std::size_t alike = 0;
  for (std::size_t t = 0; t < sequence.triangles.size(); ++t) {
    const bool right = sequence.pose(0)[sequence.triangles[t].v[0]].x > 0.5f;
    alike += growth.cluster_of_triangle[t] == (right ? 1u : 0u);
  }
  const std::size_t agreeing = std::max(alike, sequence.triangles.size() - alike);
  EXPECT_GT(static_cast<double>(agreeing), 0.97 * static_cast<double>(sequence.triangles.size()));
}

TEST(BoxGrowth, KeepsARequestedRestPoseAndCount) {
  for (const std::uint32_t count : {1u, 3u, 9u}) {
    ClusterRequest request{.clusters = count};
    request.rest_key = 5;
    const Growth growth = grown(wild_motion(70, 9), request);
    EXPECT_EQ(growth.cluster_count, count);
    EXPECT_EQ(growth.rest_key, 5u);
    EXPECT_EQ(growth.stop_reason, StopReason::kCount);
  }
}

}  // namespace
}  // namespace mdk
