// All hits and closest points against brute force, bit for bit, and what lies at a hit against
// numbers from elsewhere.
#include "common/trace/mesh_queries.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

#include "common/base/isa.h"
#include "common/motion/model_handle.h"
#include "common/trace/brute_force.h"
#include "mdk/ray_query.h"
#include "tests/agreement/test_scenes.h"

namespace mdk {
namespace {

using test::ResetIsa;

KeyInterval random_time(const ModelView& model, std::mt19937& random) {
  const auto clip = static_cast<std::uint32_t>(random() % model.clips.size());
  std::uniform_real_distribution<double> seconds(0, model.clip_seconds(model.clips[clip]) + 1e-9);
  return locate_time(model, clip, seconds(random));
}

Vec3f random_point(const Aabb& box, std::mt19937& random, float wider) {
  std::uniform_real_distribution<float> unit(-wider, wider);
  const Vec3f half = box.extent() * 0.5f;
  const Vec3f center = box.center();
  return {center.x + half.x * unit(random), center.y + half.y * unit(random),
          center.z + half.z * unit(random)};
}

/// The hits of each triangle alone.
std::vector<QueryHit> brute_force_all_hits(const ModelView& model, const PosedMesh& mesh,
                                           const QueryRay& ray) {
  std::vector<QueryHit> hits;
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
    ModelView alone = model;
    alone.triangles = model.triangles.subspan(t, 1);
    PosedMesh posed(alone);
    posed.set_time(mesh.at());
    QueryHit hit = brute_force_closest_hit(posed, ray);
    if (!hit.is_hit()) continue;
    hit.triangle = t;
    hits.push_back(hit);
  }
  std::ranges::stable_sort(hits, {}, &QueryHit::t);
  return hits;
}

bool same(const QueryHit& a, const QueryHit& b) {
  return a.t == b.t && a.triangle == b.triangle && a.bary1 == b.bary1 && a.bary2 == b.bary2;
}

TEST(MeshQueries, AllHitsAreThoseOfEachTriangleAlone) {
  std::size_t found = 0, most = 0;
  for (auto& [name, sequence] : test::agreement_scenes()) {
    const DecomposeResult baked = test::bake(std::move(sequence));
    const ModelView model = baked.model.view();
    if (model.triangle_count() > 800) continue;
    const RayTracer tracer(model);
    std::mt19937 random(11);
    std::vector<QueryHit> hits;
    for (int i = 0; i < 25; ++i) {
      PosedMesh mesh(model);
      mesh.set_time(random_time(model, random));
      const Vec3f from = random_point(model.bounds, random, 2),
                  to = random_point(model.bounds, random, 0.8f);
      QueryRay ray{from, to - from};
      if (i % 5 == 1) ray.t_min = -3;
      if (i % 5 == 2) ray.t_max = 0.9f;
      find_all_hits(tracer, ray, mesh.at(), hits);
      const std::vector<QueryHit> expected = brute_force_all_hits(model, mesh, ray);
      ASSERT_EQ(hits.size(), expected.size()) << name << ", ray " << i;
      for (std::size_t k = 0; k < hits.size(); ++k)
        ASSERT_TRUE(same(hits[k], expected[k])) << name << ", ray " << i << ", hit " << k;
      found += hits.size();
      most = std::max(most, hits.size());
    }
  }
  EXPECT_GT(found, 200u);
  EXPECT_GT(most, 2u);
}

TEST(MeshQueries, TheFirstOfAllHitsIsTheClosest) {
  const ResetIsa reset;
  const DecomposeResult baked = test::bake(test::twisting_sphere(3, 9));
  const ModelView model = baked.model.view();
  const RayTracer tracer(model);
  for (const std::string_view isa : available_isas()) {
    limit_isa(isa);
    std::mt19937 random(5);
    std::vector<QueryHit> hits;
    for (int i = 0; i < 400; ++i) {
      const KeyInterval at = random_time(model, random);
      const Vec3f from = random_point(model.bounds, random, 2);
      const QueryRay ray{from, random_point(model.bounds, random, 1) - from};
      const QueryHit closest = tracer.trace(ray, at, RayAim::kClosest);
      find_all_hits(tracer, ray, at, hits);
      ASSERT_EQ(hits.empty(), !closest.is_hit());
      if (!hits.empty()) {
        ASSERT_TRUE(same(hits.front(), closest));
      }
    }
  }
}

QueryHit brute_force_closest_point(const ModelView& model, const PosedMesh& mesh, const Vec3f& p,
                                   float radius) {
  QueryHit best;
  const auto positions = mesh.positions();
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
    const Triangle& corners = model.triangles[t];
    const TrianglePoint q =
        closest_on_triangle(to_double(p), to_double(positions[corners.v[0]]),
                            to_double(positions[corners.v[1]]), to_double(positions[corners.v[2]]));
    const auto d = static_cast<float>(std::sqrt(q.square));
    if (d <= radius && d < best.t)
      best = {d, t, static_cast<float>(q.bary1), static_cast<float>(q.bary2)};
  }
  return best;
}

TEST(MeshQueries, ClosestPointsAreBruteForces) {
  std::size_t found = 0, missed = 0;
  for (auto& [name, sequence] : test::agreement_scenes()) {
    const DecomposeResult baked = test::bake(std::move(sequence));
    const ModelView model = baked.model.view();
    const RayTracer tracer(model);
    std::mt19937 random(3);
    const float size = diagonal(model.bounds);
    for (int i = 0; i < 60; ++i) {
      PosedMesh mesh(model);
      mesh.set_time(random_time(model, random));
      const Vec3f p = random_point(model.bounds, random, i % 2 == 0 ? 1.0f : 4.0f);
      const float radius = i % 3 == 0 ? std::numeric_limits<float>::infinity() : size * 0.1f;
      const QueryHit got = find_closest_point(tracer, p, radius, mesh.at());
      ASSERT_TRUE(same(got, brute_force_closest_point(model, mesh, p, radius)))
          << name << ", point " << i;
      ++(got.is_hit() ? found : missed);
    }
  }
  EXPECT_GT(found, 100u);
  EXPECT_GT(missed, 20u);
}

TEST(MeshQueries, NoPointOfATriangleIsCloserThanTheClosest) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto point = [&] { return Vec3d{unit(random), unit(random), unit(random)}; };
  for (int i = 0; i < 300; ++i) {
    const Vec3d a = point(), b = point();
    const Vec3d c = i % 4 == 0 ? a + (b - a) * unit(random) : i % 7 == 0 ? a : point();
    const Vec3d p = point() * 2.0;
    const TrianglePoint closest = closest_on_triangle(p, a, b, c);
    EXPECT_GE(closest.bary1, 0);
    EXPECT_GE(closest.bary2, 0);
    EXPECT_LE(closest.bary1 + closest.bary2, 1 + 1e-12);
    for (int u = 0; u <= 20; ++u)
      for (int v = 0; u + v <= 20; ++v) {
        const Vec3d off = a + (b - a) * (u / 20.0) + (c - a) * (v / 20.0) - p;
        ASSERT_GE(dot(off, off), closest.square - 1e-12);
      }
  }
}

// A square that moves along x by 2 in the first second and by -1 in the next two.
Model moving_square() {
  PoseSequence sequence;
  sequence.vertex_count = 4;
  sequence.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  sequence.clips = {{"slide", 0, 3}};
  sequence.key_times = {0, 1, 3};
  for (const float x : {0.0f, 2.0f, 1.0f})
    for (const Vec3f& p : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{1, 1, 0}, Vec3f{0, 1, 0}})
      sequence.positions.push_back({p.x + x, p.y, p.z});
  sequence.appearance.materials.emplace_back().base_color[1] = 0.25f;
  sequence.appearance.triangle_materials = {0, 0};
  const auto model = std::make_shared<const ModelStorage>(test::bake(std::move(sequence)).model);
  return ModelHandle::make(model->view(), model);
}

TEST(MeshQueries, SurfacesHavePositionNormalVelocityAndColour) {
  const Model model = moving_square();
  const RayQuery query(model);
  const auto surface_at = [&](double seconds, float x) {
    const KeyInterval time = model.locate_time(0, seconds);
    const QueryHit hit = query.closest_hit({{x, 0.25f, 5}, {0, 0, -1}}, time);
    EXPECT_TRUE(hit.is_hit());
    return query.surface(hit, time);
  };
  const Surface early = surface_at(0.5, 1.5f);
  EXPECT_NEAR(early.position.x, 1.5f, 1e-5f);
  EXPECT_NEAR(early.position.y, 0.25f, 1e-5f);
  EXPECT_NEAR(early.normal.z, 1, 1e-6f);
  EXPECT_NEAR(early.smooth_normal.z, 1, 1e-6f);
  EXPECT_NEAR(early.velocity.x, 2, 1e-5f);
  EXPECT_NEAR(early.base_color[1], 0.25f, 1e-6f);
  EXPECT_LT(early.source_triangle, 2u);
  EXPECT_NEAR(surface_at(2, 2).velocity.x, -0.5f, 1e-5f);
  EXPECT_NEAR(surface_at(1, 2.5f).velocity.x, -0.5f, 1e-5f);  // a key goes on with what follows
  EXPECT_NEAR(surface_at(3, 1.5f).velocity.x, -0.5f, 1e-5f);  // and the last with what came before
}

}  // namespace
}  // namespace mdk
