// Single rays through scenes against brute force over all instances, bit for bit: instances that
// stand and move, mirrored, sheared, scaled, at times of their own.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <numeric>

#include "common/base/isa.h"
#include "common/base/parallel.h"
#include "common/motion/model_handle.h"
#include "common/trace/scene_tracer.h"
#include "tests/agreement/test_scenes.h"
#include "tests/common/random_boxes.h"
#include "tests/common/random_scene.h"

namespace mdk {
namespace {

using test::ResetIsa;

bool is_same(const SceneHit& a, const SceneHit& b) {
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
  return a.instance == b.instance && a.triangle == b.triangle && bits(a.t) == bits(b.t) &&
         bits(a.bary1) == bits(b.bary1) && bits(a.bary2) == bits(b.bary2) && a.id == b.id;
}

Model baked(PoseSequence sequence) {
  auto result = std::make_shared<DecomposeResult>(test::bake(std::move(sequence)));
  return ModelHandle::make(result->model.view(), result);
}

const std::vector<Model>& models() {
  static const std::vector<Model> made{baked(test::bending_tube(6, 8, 7)),
                                       baked(test::flying_boxes(6, 5)),
                                       baked(test::random_triangles(60, 4, 2, 1))};
  return made;
}

/// From anywhere in or around the scene to somewhere in an instance's box.
QueryRay random_ray(const Stage& stage, double time, test::Random& random) {
  const auto point_of = [&] {
    Aabb box;
    for (int tries = 0; tries < 20 && box.empty(); ++tries)
      box = stage.box_at(static_cast<std::uint32_t>(random.below(stage.instance_count())), time);
    return box.empty() ? Vec3f{} : random.point(box);
  };
  QueryRay ray;
  ray.origin =
      point_of() + (random.below(2) == 0 ? random.point({{-60, -60, -60}, {60, 60, 60}}) : Vec3f{});
  ray.direction = point_of() - ray.origin;
  if (random.below(8) == 0) ray.direction = {0, 0, -1};
  ray.direction = ray.direction * std::ldexp(1.0f, static_cast<int>(random.below(40)) - 20);
  const float length = mdk::length(ray.direction);
  if (random.below(4) == 0 && length > 0) ray.t_max = random.between(0.1f, 60) / length;
  if (random.below(4) == 0 && length > 0) ray.t_min = random.between(-20, 5) / length;
  if (!(ray.t_min < ray.t_max)) ray.t_min = 0;
  return ray;
}

class SceneRays : public testing::TestWithParam<std::uint32_t> {};

TEST_P(SceneRays, HitWhatBruteForceHits) {
  const ResetIsa reset;
  const std::uint32_t instances = GetParam();
  const int rays = instances > 100 ? 150 : 400;
  int hits = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const SceneStorage scene = test::random_scene(models(), instances, 30, 100 + seed);
    ASSERT_EQ(scene_fault(scene.view()), "");
    const Stage stage(scene.view(), models());
    const SceneTracer tracer(stage);
    test::Random random(seed);
    for (int i = 0; i < rays; ++i) {
      const double time = -20 + 110 * random.unit();
      const QueryRay ray = random_ray(stage, time, random);
      const std::uint32_t mask = random.below(3) == 0 ? 1 : kAllInstances;
      reset_isa();
      const SceneHit expected = brute_force_closest_hit(stage, ray, time, mask);
      hits += expected.is_hit();
      for (const std::string_view isa : available_isas()) {
        limit_isa(isa);
        const SceneHit hit = tracer.trace(ray, time, RayAim::kClosest, mask);
        EXPECT_TRUE(is_same(hit, expected))
            << "seed " << seed << ", ray " << i << ", " << isa << ": " << hit.instance << " at "
            << hit.t << ", not " << expected.instance << " at " << expected.t;
        EXPECT_EQ(tracer.trace(ray, time, RayAim::kAny, mask).is_hit(), expected.is_hit());
      }
    }
  }
  EXPECT_GT(hits, 100);
}

INSTANTIATE_TEST_SUITE_P(Sizes, SceneRays, testing::Values(2, 17, 300));

/// The same character many times in one place: all hits tie.
TEST(SceneRays, TiesGoToTheLowerInstance) {
  SceneStorage scene;
  scene.model_count = 1;
  scene.roles = {{0, 0}};
  scene.instances.resize(40);
  for (SceneInstance& instance : scene.instances) instance.map.m[0][3] = 3;
  scene.labels.resize(40);
  scene.labels[0].mask = 2;
  scene.labels[1].mask = 2;
  scene.labels[2].id = -5;
  const Stage stage(scene.view(), {models()[0]});
  const SceneTracer tracer(stage);
  const Aabb box = stage.box_at(0, 0.1);
  const QueryRay ray{{box.center().x, box.center().y, 50}, {0, 0, -1}};
  const SceneHit all = tracer.trace(ray, 0.1, RayAim::kClosest),
                 some = tracer.trace(ray, 0.1, RayAim::kClosest, 1);
  EXPECT_EQ(all.instance, 0u);
  EXPECT_EQ(some.instance, 2u);
  EXPECT_EQ(some.id, -5);
  EXPECT_EQ(some.t, all.t);
}

}  // namespace
}  // namespace mdk
