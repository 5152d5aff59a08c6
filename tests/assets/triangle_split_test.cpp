#include "assets/triangle_split.h"

#include <gtest/gtest.h>

#include "tests/assets/mesh_topology.h"

namespace mdk {
namespace {

/// A tetrahedron whose corners hang on different joints.
GlbMesh tetrahedron() {
  GlbMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.normals = {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.colors = {{0, 0, 0, 255}, {255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}};
  mesh.joints = {{1, 2, 3, 4}, {5, 6, 7, 8}, {1, 0, 0, 0}, {9, 1, 0, 0}};
  mesh.weights = {{20000, 20000, 15535, 10000},
                  {16384, 16384, 16384, 16383},
                  {65535, 0, 0, 0},
                  {40000, 25535, 0, 0}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

TEST(TriangleSplit, KeepsTheSurfaceClosedAndWhereItIs) {
  GlbMesh mesh = tetrahedron();
  const double volume = enclosed_volume(mesh.triangles, mesh.positions);
  for (std::size_t level = 1; level <= 4; ++level) {
    split_mesh(mesh);
    EXPECT_EQ(mesh.triangles.size(), std::size_t{4} << (2 * level));
    EXPECT_EQ(unmatched_edges(mesh.triangles), 0u);
    EXPECT_EQ(euler_characteristic(mesh.triangles, mesh.positions.size()), 2);
    EXPECT_NEAR(enclosed_volume(mesh.triangles, mesh.positions), volume, 1e-12);
  }
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  EXPECT_EQ(mesh.colors.size(), mesh.positions.size());
}

TEST(TriangleSplit, WeightsOfAMiddleAreTheMeanOfBothEnds) {
  GlbMesh mesh = tetrahedron();
  split_mesh(mesh);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    int sum = 0;
    for (const std::uint16_t w : mesh.weights[v]) sum += w;
    EXPECT_EQ(sum, 65535) << v;
  }
  // Between corners 2 and 3: joint 1 has (65535 + 25535) / 2, joint 9 the rest.
  const Vec3d middle{0, 0.5, 0.5};
  std::size_t v = 0;
  while (v < mesh.positions.size() && !(mesh.positions[v] == middle)) ++v;
  ASSERT_LT(v, mesh.positions.size());
  EXPECT_EQ(mesh.joints[v][0], 1);
  EXPECT_NEAR(mesh.weights[v][0], 45535, 1);
  EXPECT_EQ(mesh.joints[v][1], 9);
  EXPECT_NEAR(mesh.weights[v][1], 20000, 1);
}

TEST(TriangleSplit, SequencesMoveBetweenTheirCorners) {
  SampleSequence sequence;
  sequence.triangles = {{0, 1, 2}};
  sequence.colors = {{0, 0, 0}, {255, 255, 255}, {10, 20, 30}};
  sequence.poses = {{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 0, 4}, {2, 0, 0}, {0, 2, 0}}};
  split_sequence(sequence);
  EXPECT_EQ(sequence.triangles.size(), 4u);
  ASSERT_EQ(sequence.poses[1].size(), 6u);
  EXPECT_EQ(sequence.poses[1][3], (Vec3d{1, 0, 2}));
  EXPECT_EQ(sequence.colors[3], (ByteColor{128, 128, 128}));
}

}  // namespace
}  // namespace mdk
