#include "common/motion/posed_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace mdk {
namespace {

/// Two keys, one cluster, wild vertices; world boxes hold the vertices at the keys.
ModelStorage two_keys(std::uint32_t vertices) {
  ModelStorage m;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-100, 100);
  m.vertex_count = vertices;
  m.clips = {{"c", 0, 2}};
  m.key_times = {0, 1};
  for (std::uint32_t i = 0; i < 2 * vertices; ++i)
    m.key_positions.push_back({unit(random), unit(random), unit(random)});
  for (std::uint32_t i = 0; i + 2 < vertices; i += 3) m.triangles.push_back({{i, i + 1, i + 2}});
  m.cluster_world_boxes.resize(2);
  for (std::size_t i = 0; i < m.key_positions.size(); ++i)
    m.cluster_world_boxes[i / vertices].extend(m.key_positions[i]);
  m.clusters.resize(1);
  m.clusters[0].triangle_count = static_cast<std::uint32_t>(m.triangles.size());
  return m;
}

TEST(PosedMesh, AtAKeyThePoseIsTheModelsOwnMemory) {
  const ModelStorage storage = two_keys(30);
  const Model model = storage.view();
  PosedMesh mesh(model);
  mesh.set_time(at_key(1));
  EXPECT_EQ(mesh.positions().data(), model.key_pose(1).data());
}

TEST(PosedMesh, BetweenKeysVerticesMoveLinearly) {
  const ModelStorage storage = two_keys(30);
  const Model model = storage.view();
  PosedMesh mesh(model);
  mesh.set_time({0, 1, 0.25f});
  for (std::uint32_t i = 0; i < 30; ++i) {
    const Vec3f a = model.key_pose(0)[i], b = model.key_pose(1)[i];
    EXPECT_FLOAT_EQ(mesh.positions()[i].x, a.x + 0.25f * (b.x - a.x));
    EXPECT_FLOAT_EQ(mesh.positions()[i].z, a.z + 0.25f * (b.z - a.z));
  }
}

TEST(PosedMesh, TriangleBoxesHoldTheirCornersTightly) {
  const ModelStorage storage = two_keys(60);
  const Model model = storage.view();
  PosedMesh mesh(model);
  mesh.set_time({0, 1, 0.7f});
  std::vector<Aabb> boxes(model.triangle_count());
  triangle_boxes(mesh, boxes);
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    Aabb expected;
    for (const std::uint32_t v : model.triangles[t].v) expected.extend(mesh.positions()[v]);
    EXPECT_EQ(boxes[t], expected);
  }
}

TEST(PosedMesh, BoxesAreFiniteWhateverTheCornersAre) {
  ModelStorage storage = two_keys(9);
  const float inf = std::numeric_limits<float>::infinity();
  storage.key_positions[1] = {std::nanf(""), 0, 0};
  for (int i = 3; i < 6; ++i) storage.key_positions[i] = {std::nanf(""), inf, -inf};
  const Model model = storage.view();
  PosedMesh mesh(model);
  mesh.set_time(at_key(0));
  std::vector<Aabb> boxes(model.triangle_count());
  triangle_boxes(mesh, boxes);
  for (const Aabb& box : boxes) {
    EXPECT_FALSE(box.empty());
    EXPECT_TRUE(std::isfinite(box.diagonal()));
  }
}

TEST(PosedMesh, InterpolatedWorldBoxHoldsTheInterpolatedVertices) {
  const ModelStorage storage = two_keys(300);
  const Model model = storage.view();
  PosedMesh mesh(model);
  for (const float s : {0.001f, 0.3f, 0.5f, 0.999f}) {
    mesh.set_time({0, 1, s});
    Aabb box = cluster_world_box(model, 0, mesh.at());
    const float slack = 1e-4f;  // the stored boxes of real models are padded; these are not
    box.lo = box.lo - Vec3f{slack, slack, slack};
    box.hi = box.hi + Vec3f{slack, slack, slack};
    for (const Vec3f& p : mesh.positions()) EXPECT_TRUE(box.contains(p)) << s;
  }
}

}  // namespace
}  // namespace mdk
