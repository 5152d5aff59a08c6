// Clusters by the cost of their boxes, on meshes small and large.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "preprocess/cluster/boxes/box_clusters.h"
#include "preprocess/cluster/clusters.h"
#include "preprocess/pose/pose_table.h"
#include "tests/preprocess/moving_meshes.h"
#include "tests/preprocess/whole_sequence.h"

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

/// A ball of `bands` by 2 `bands` quads; `is_flat_shaded`: with corners of its own for each
/// triangle.
Mesh ball(std::uint32_t bands, const Vec3d& center, bool is_flat_shaded) {
  constexpr double kPi = 3.14159265358979323846;
  Mesh mesh;
  const auto corner = [&](std::uint32_t i, std::uint32_t j) {
    const double up = kPi * i / bands, round = kPi * j / bands;
    return center +
           Vec3d{std::sin(up) * std::cos(round), std::sin(up) * std::sin(round), std::cos(up)};
  };
  if (!is_flat_shaded)
    for (std::uint32_t i = 0; i <= bands; ++i)
      for (std::uint32_t j = 0; j < 2 * bands; ++j) mesh.vertices.push_back(corner(i, j));
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
    if (!is_flat_shaded) return i * 2 * bands + j % (2 * bands);
    mesh.vertices.push_back(corner(i, j % (2 * bands)));
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  };
  for (std::uint32_t i = 0; i < bands; ++i)
    for (std::uint32_t j = 0; j < 2 * bands; ++j) {
      mesh.triangles.push_back({{vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)}});
      mesh.triangles.push_back({{vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)}});
    }
  return mesh;
}

/// Balls that turn and move apart from one another, joined into one mesh; and a bending sheet.
PoseSequence balls_and_a_sheet(std::uint32_t balls, bool is_flat_shaded,
                               std::vector<std::uint32_t>& part_of_triangle) {
  Mesh mesh = curved_sheet(20);
  std::vector<std::uint32_t> part_of_vertex(mesh.vertices.size(), balls);
  part_of_triangle.assign(mesh.triangles.size(), balls);
  for (std::uint32_t b = 0; b < balls; ++b) {
    mesh = joined(mesh, ball(24, {3.0 * b, 0, 0}, is_flat_shaded));
    part_of_vertex.resize(mesh.vertices.size(), b);
    part_of_triangle.resize(mesh.triangles.size(), b);
  }
  return make_sequence(mesh, 20, [&](std::uint32_t k, std::uint32_t i) {
    Vec3d v = mesh.vertices[i];
    const std::uint32_t part = part_of_vertex[i];
    if (part == balls) {
      v.z += 0.5 * std::sin(0.5 * k + 5 * v.x);
      return v;
    }
    const Vec3d center{3.0 * part, 0, 0};
    return rigid_motion({1, part + 1.0, 2}, 0.2 * (part + 1) * k, center).point(v - center) +
           Vec3d{0.1 * k, 0.05 * part * k, 0};
  });
}

TEST(RigidParts, AreFoundByTheirMotionThoughTheirTrianglesShareNoVertices) {
  for (const bool is_flat_shaded : {false, true}) {
    std::vector<std::uint32_t> part_of_triangle;
    const PoseSequence sequence = balls_and_a_sheet(3, is_flat_shaded, part_of_triangle);
    const PoseTable table = whole_table(sequence);
    const auto parts = find_rigid_parts({table, sequence.triangles});
    ASSERT_EQ(parts.size(), 3u) << is_flat_shaded;
    for (const std::vector<std::uint32_t>& part : parts) {
      EXPECT_EQ(part.size(), 4u * 24 * 24);
      for (const std::uint32_t t : part) EXPECT_EQ(part_of_triangle[t], part_of_triangle[part[0]]);
    }
  }
}

TEST(RigidParts, NeverBecomeSeveralClusters) {
  for (const std::uint32_t balls : {1u, 2u, 5u}) {
    std::vector<std::uint32_t> part_of_triangle;
    const PoseSequence sequence = balls_and_a_sheet(balls, balls == 2, part_of_triangle);
    const Growth growth = grown(sequence, {});
    std::vector<std::set<std::uint32_t>> clusters(balls + 1);
    for (std::size_t t = 0; t < sequence.triangles.size(); ++t)
      clusters[part_of_triangle[t]].insert(growth.cluster_of_triangle[t]);
    for (std::uint32_t b = 0; b < balls; ++b)
      EXPECT_EQ(clusters[b].size(), 1u) << "ball " << b << " of " << balls;
  }
}

TEST(RigidParts, AreNotCutWhereClustersOfManyPartsMeet) {
  // A snake of balls: far more parts than clusters pay, so that each cluster has several, and boxes
  // alone would put its ends anywhere.
  constexpr std::uint32_t kLinks = 60;
  Mesh mesh;
  std::vector<std::uint32_t> link_of_vertex, link_of_triangle;
  const auto center = [](std::uint32_t link) { return Vec3d{1.2 * link, 0, 0}; };
  for (std::uint32_t link = 0; link < kLinks; ++link) {
    mesh = joined(mesh, ball(6, center(link), false));
    link_of_vertex.resize(mesh.vertices.size(), link);
    link_of_triangle.resize(mesh.triangles.size(), link);
  }
  const PoseSequence sequence = make_sequence(mesh, 24, [&](std::uint32_t k, std::uint32_t i) {
    const std::uint32_t link = link_of_vertex[i];
    const double phase = 0.12 * link + 0.5 * k;
    const Vec3d rest = center(link), moved = rest + Vec3d{0, 8 * std::sin(phase), 0};
    return rigid_motion({0, 0, 1}, std::atan(0.8 * std::cos(phase)), {})
               .point(mesh.vertices[i] - rest) +
           moved;
  });
  const Growth growth = grown(sequence, {});
  EXPECT_GT(growth.cluster_count, 3u);
  EXPECT_LT(growth.cluster_count, kLinks);
  std::vector<std::set<std::uint32_t>> clusters(kLinks);
  for (std::size_t t = 0; t < sequence.triangles.size(); ++t)
    clusters[link_of_triangle[t]].insert(growth.cluster_of_triangle[t]);
  for (std::uint32_t link = 0; link < kLinks; ++link)
    EXPECT_EQ(clusters[link].size(), 1u) << "link " << link;
}

TEST(RigidParts, ComeTogetherInTheClusterThatFollowsThem) {
  std::vector<std::uint32_t> part_of_triangle;
  const PoseSequence sequence = balls_and_a_sheet(2, false, part_of_triangle);
  const PoseTable table = whole_table(sequence);
  const BoxProblem problem{{table, sequence.triangles}, {0, row_box_areas(table), 1}};
  std::vector<std::uint32_t> assignment = part_of_triangle;
  std::size_t moved = 0;  // some of ball 0 to the sheet and to a cluster of their own
  for (std::uint32_t t = 0; t < assignment.size(); ++t)
    if (part_of_triangle[t] == 0 && t % 3 != 0) assignment[t] = ++moved % 2 == 0 ? 2 : 3;
  const BoxClustering cut = fit_boxes(problem, assignment);
  ASSERT_EQ(cut.cluster_count, 4u);
  const BoxClustering whole = with_whole_parts(problem, cut, find_rigid_parts(problem.mesh));
  EXPECT_EQ(whole.cluster_count, 3u);
  EXPECT_LT(whole.cost, cut.cost);
}

}  // namespace
}  // namespace mdk
