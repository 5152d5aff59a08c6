#include "common/motion/posed_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "tests/common/random_rig.h"

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
    m.poses.key_positions.push_back({unit(random), unit(random), unit(random)});
  for (std::uint32_t i = 0; i + 2 < vertices; i += 3) m.triangles.push_back({{i, i + 1, i + 2}});
  m.key_boxes.resize(2);
  for (std::size_t i = 0; i < m.poses.key_positions.size(); ++i)
    m.key_boxes[i / vertices].extend(m.poses.key_positions[i]);
  for (const Aabb& box : m.key_boxes) m.cluster_world_boxes.push_back(quantize_outward(box, box));
  m.clusters.resize(1);
  m.clusters[0].triangle_count = static_cast<std::uint32_t>(m.triangles.size());
  return m;
}

TEST(PosedMesh, AtAKeyThePoseIsTheModelsOwnMemory) {
  const ModelStorage storage = two_keys(30);
  const ModelView model = storage.view();
  PosedMesh mesh(model);
  mesh.set_time(at_key(1));
  EXPECT_EQ(mesh.positions().data(), &model.poses.key_positions[30]);
}

TEST(PosedMesh, BetweenKeysVerticesMoveLinearly) {
  const ModelStorage storage = two_keys(30);
  const ModelView model = storage.view();
  PosedMesh mesh(model);
  mesh.set_time({0, 1, 0.25f});
  for (std::uint32_t i = 0; i < 30; ++i) {
    const Vec3f a = model.poses.key_positions[i], b = model.poses.key_positions[30 + i];
    EXPECT_FLOAT_EQ(mesh.positions()[i].x, a.x + 0.25f * (b.x - a.x));
    EXPECT_FLOAT_EQ(mesh.positions()[i].z, a.z + 0.25f * (b.z - a.z));
  }
}

/// Four keys, a rig of wild numbers.
ModelStorage rigged(std::uint32_t vertices) {
  ModelStorage m = two_keys(vertices);
  m.clips = {{"c", 0, 4}};
  m.key_times = {0, 1, 2, 3};
  m.poses = {PoseKind::kRig, {}, random_rig({.vertices = vertices, .keys = 4}, 5), {}};
  return m;
}

TEST(PosedMesh, DecodedPosesDoNotDependOnWhatWasDecodedBefore) {
  const ModelStorage storage = rigged(5000);
  const ModelView model = storage.view();
  PosedMesh wandering(model);
  for (const KeyInterval& at :
       {at_key(2), KeyInterval{1, 2, 0.5f}, KeyInterval{2, 3, 0.25f}, at_key(3), at_key(0),
        KeyInterval{0, 1, 0.75f}, KeyInterval{2, 3, 0.5f}, at_key(2), KeyInterval{1, 2, 0.5f}}) {
    wandering.set_time(at);
    PosedMesh fresh(model);
    fresh.set_time(at);
    ASSERT_TRUE(std::ranges::equal(wandering.positions(), fresh.positions()))
        << at.key0 << " " << at.key1 << " " << at.s;
  }
}

TEST(PosedMesh, BetweenKeysDecodedVerticesMoveLinearly) {
  const ModelStorage storage = rigged(100);
  const ModelView model = storage.view();
  std::vector<Vec3f> from(100), to(100);
  decode_pose(model, 1, {0, 100}, from);
  decode_pose(model, 2, {0, 100}, to);
  PosedMesh mesh(model);
  mesh.set_time({1, 2, 0.25f});
  for (std::size_t i = 0; i < from.size(); ++i)
    EXPECT_EQ(mesh.positions()[i], from[i] + (to[i] - from[i]) * 0.25f);
}

/// The same in clusters of `each` triangles, which share vertices with the next.
ModelStorage clustered(ModelStorage m, std::uint32_t each) {
  m.triangles.clear();
  for (std::uint32_t i = 0; i + 2 < m.vertex_count; ++i) m.triangles.push_back({{i, i + 1, i + 2}});
  const auto count = static_cast<std::uint32_t>(m.triangles.size());
  m.clusters.clear();
  for (std::uint32_t first = 0; first < count; first += each)
    m.clusters.push_back({first, std::min(each, count - first)});
  return m;
}

TEST(PosedMesh, PosesOnlyTheClustersThatAreAskedFor) {
  const ModelStorage rig = clustered(rigged(5000), 100), keys = clustered(two_keys(5000), 100);
  for (const ModelView& model : {rig.view(), keys.view()}) {
    const KeyInterval at{0, 1, 0.5f};
    PosedMesh whole(model), part(model);
    whole.set_time(at);
    part.set_time(at);
    EXPECT_EQ(part.posed_count(), 0u);
    part.require(7);
    EXPECT_GE(part.posed_count(), 102u);
    EXPECT_LE(part.posed_count(), 204u) << "the cluster, and the one that owns its first vertices";
    for (std::uint32_t v = 700; v < 802; ++v)
      ASSERT_EQ(part.posed_so_far()[v], whole.positions()[v]);
    part.require_around(7);
    for (std::uint32_t v = 600; v < 902; ++v)
      ASSERT_EQ(part.posed_so_far()[v], whole.positions()[v]);
    EXPECT_LT(part.posed_count(), 500u);
    EXPECT_TRUE(std::ranges::equal(part.positions(), whole.positions()));
    EXPECT_EQ(part.posed_count(), 5000u);
  }
}

TEST(PosedMesh, WhatWasDecodedInPartIsCompletedAtOtherMoments) {
  const ModelStorage storage = clustered(rigged(3000), 50);
  const ModelView model = storage.view();
  PosedMesh wandering(model);
  std::mt19937 random(11);
  const KeyInterval moments[] = {at_key(1), {1, 2, 0.5f}, {1, 2, 0.75f}, at_key(2), {2, 3, 0.25f}};
  for (int round = 0; round < 60; ++round) {
    const KeyInterval& at = moments[random() % std::size(moments)];
    PosedMesh fresh(model);
    fresh.set_time(at);
    wandering.set_time(at);
    if (random() % 4 == 0) wandering.positions();
    for (int i = 0; i < 3; ++i) {
      const auto c = static_cast<std::uint32_t>(random() % model.cluster_count());
      wandering.require(c);
      for (const Triangle& t : model.triangles.subspan(model.clusters[c].first_triangle,
                                                       model.clusters[c].triangle_count))
        for (const std::uint32_t v : t.v)
          ASSERT_EQ(wandering.posed_so_far()[v], fresh.positions()[v]) << round;
    }
  }
}

TEST(PosedMesh, ManyThreadsMayAskForTheSameClusters) {
  const ModelStorage storage = clustered(rigged(20000), 300);
  const ModelView model = storage.view();
  PosedMesh asked(model), whole(model);
  for (int round = 0; round < 20; ++round) {
    const KeyInterval at{0, 1, 0.02f + 0.04f * static_cast<float>(round)};
    whole.set_time(at);
    asked.set_time(at);
    const auto ask = [&](std::uint32_t step) {
      for (std::uint32_t i = 0; i < model.cluster_count(); ++i)
        asked.require(i * step % model.cluster_count());
    };
    std::thread other(ask, 1), third(ask, 5);
    ask(1);
    other.join();
    third.join();
    for (std::uint32_t v = 0; v < model.vertex_count; ++v)
      ASSERT_EQ(asked.posed_so_far()[v], whole.positions()[v]);
  }
}

TEST(PosedMesh, AnyRangeOfVerticesDecodesToTheSameBits) {
  const ModelStorage rig = rigged(300), keys = two_keys(300);
  for (const ModelView& model : {rig.view(), keys.view()}) {
    std::vector<Vec3f> all(300), part(300);
    decode_pose(model, 1, {0, 300}, all);
    for (const VertexRange range : {VertexRange{0, 1}, {17, 17}, {5, 130}, {299, 300}}) {
      decode_pose(model, 1, range, std::span(part).first(range.size()));
      for (std::uint32_t i = 0; i < range.size(); ++i)
        ASSERT_EQ(part[i], all[range.begin + i]) << range.begin;
    }
  }
}

TEST(PosedMesh, TriangleBoxesHoldTheirCornersTightly) {
  const ModelStorage storage = two_keys(60);
  const ModelView model = storage.view();
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
  storage.poses.key_positions[1] = {std::nanf(""), 0, 0};
  for (int i = 3; i < 6; ++i) storage.poses.key_positions[i] = {std::nanf(""), inf, -inf};
  const ModelView model = storage.view();
  PosedMesh mesh(model);
  mesh.set_time(at_key(0));
  std::vector<Aabb> boxes(model.triangle_count());
  triangle_boxes(mesh, boxes);
  for (const Aabb& box : boxes) {
    EXPECT_FALSE(box.empty());
    EXPECT_TRUE(std::isfinite(diagonal(box)));
  }
}

TEST(PosedMesh, InterpolatedWorldBoxHoldsTheInterpolatedVertices) {
  const ModelStorage storage = two_keys(300);
  const ModelView model = storage.view();
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
