// Where instances are: the clock, maps between keys, and boxes that hold at every time.
#include "common/scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "common/motion/posed_mesh.h"
#include "tests/common/random_boxes.h"
#include "tests/common/random_scene.h"

namespace mdk {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(SceneClock, WrapsTimesIntoTheClip) {
  EXPECT_EQ(wrapped_time(2.5, 2, ClipWrap::kLoop), 0.5);
  EXPECT_EQ(wrapped_time(-0.5, 2, ClipWrap::kLoop), 1.5);
  EXPECT_EQ(wrapped_time(2e9 + 0.5, 2, ClipWrap::kLoop), 0.5);
  EXPECT_EQ(wrapped_time(2.5, 2, ClipWrap::kOnce), 2);
  EXPECT_EQ(wrapped_time(-3, 2, ClipWrap::kOnce), 0);
  EXPECT_EQ(wrapped_time(2.5, 2, ClipWrap::kPingPong), 1.5);
  EXPECT_EQ(wrapped_time(4.25, 2, ClipWrap::kPingPong), 0.25);
  EXPECT_EQ(wrapped_time(-0.25, 2, ClipWrap::kPingPong), 0.25);
  EXPECT_EQ(wrapped_time(7, 0, ClipWrap::kLoop), 0);
  EXPECT_EQ(wrapped_time(std::numeric_limits<double>::infinity(), 2, ClipWrap::kLoop), 0);
}

SceneStorage one_instance(const SceneInstance& instance, std::vector<PathKey> keys,
                          PathEnds ends = PathEnds::kHold) {
  SceneStorage scene;
  scene.model_count = 1;
  scene.roles = {{0, 0}};
  scene.instances = {instance};
  scene.labels.resize(1);
  if (!keys.empty()) {
    scene.instances[0].bits |= 1u << 31;
    scene.paths = {{0, static_cast<std::uint32_t>(keys.size()), ends}};
    scene.path_keys = std::move(keys);
  }
  return scene;
}

PathKey turned_about_z(double time, double angle, Vec3f at = {}) {
  return {time,
          at,
          {0, 0, static_cast<float>(std::sin(angle / 2)), static_cast<float>(std::cos(angle / 2))},
          {1, 1, 1}};
}

TEST(SceneMaps, TurnAtAConstantRateByTheShorterWay) {
  const Model model = test::random_points(3, 1);
  const SceneStorage scene =
      one_instance({}, {turned_about_z(1, 0.2), turned_about_z(3, 0.2 + 0.97 * kPi, {4, 0, 0}),
                        turned_about_z(4, 0.2 + 1.9 * kPi)});
  const Stage stage(scene.view(), {model});
  for (double time = 0.5; time < 4.5; time += 0.01) {
    const double angle = time <= 1   ? 0.2
                         : time <= 3 ? 0.2 + 0.97 * kPi * (time - 1) / 2
                         : time <= 4 ? 0.2 + 0.97 * kPi + 0.93 * kPi * (time - 3)
                                     : 0.2 + 1.9 * kPi;
    const Affine3f map = stage.world_from_model(0, time);
    EXPECT_NEAR(map.m[0][0], std::cos(angle), 5e-7) << time;
    EXPECT_NEAR(map.m[1][0], std::sin(angle), 5e-7) << time;
    EXPECT_NEAR(map.m[0][3],
                time <= 1   ? 0
                : time <= 3 ? 2 * (time - 1)
                : time <= 4 ? 4 * (4 - time)
                            : 0,
                1e-6)
        << time;
  }
}

TEST(SceneMaps, PathsHoldHideAndLoop) {
  const Model model = test::random_points(3, 1);
  const std::vector<PathKey> keys{turned_about_z(1, 0, {0, 0, 0}), turned_about_z(3, 0, {8, 0, 0})};
  const auto x_at = [&](PathEnds ends, double time) {
    const SceneStorage scene = one_instance({}, keys, ends);
    const Stage stage(scene.view(), {model});
    return stage.is_shown(0, time) ? stage.world_from_model(0, time).m[0][3] : -1.0f;
  };
  EXPECT_EQ(x_at(PathEnds::kHold, 0), 0);
  EXPECT_EQ(x_at(PathEnds::kHold, 9), 8);
  EXPECT_EQ(x_at(PathEnds::kHide, 0), -1);
  EXPECT_EQ(x_at(PathEnds::kHide, 3), 8);
  EXPECT_EQ(x_at(PathEnds::kHide, 3.001), -1);
  EXPECT_EQ(x_at(PathEnds::kLoop, 3.5), 2);
  EXPECT_EQ(x_at(PathEnds::kLoop, 0.5), 6);
}

/// Whether a box holds the vertices of an instance, mapped in double.
class BoxCheck {
 public:
  BoxCheck(const Stage& stage, std::uint32_t i, double time)
      : map_(to_double(stage.world_from_model(i, time))), mesh_(stage.model_of(i)) {
    mesh_.set_time(stage.key_interval(i, time));
  }

  /// How many vertices are outside.
  int outside(const Aabb& box) const {
    const Aabbd wide{to_double(box.lo), to_double(box.hi)};
    int count = 0;
    for (const Vec3f& v : mesh_.positions()) count += !wide.contains(map_.point(to_double(v)));
    return count;
  }
  Aabbd tight() const {
    Aabbd box;
    for (const Vec3f& v : mesh_.positions()) box.extend(map_.point(to_double(v)));
    return box;
  }

 private:
  Affine3d map_;
  PosedMesh mesh_;
};

TEST(SceneBoxes, HoldAtAMillionRandomTimes) {
  const std::vector<Model> models{test::random_points(8, 1), test::random_points(8, 2)};
  test::Random random(5);
  int violations = 0;
  std::size_t checked = 0, shown = 0;
  for (std::uint64_t seed = 0; checked < 1'000'000; ++seed) {
    const float reach = seed % 3 == 0 ? 1 : seed % 3 == 1 ? 100 : 1e5f;
    const SceneStorage scene = test::random_scene(models, 500, reach, seed);
    ASSERT_EQ(scene_fault(scene.view()), "");
    const Stage stage(scene.view(), models);
    for (std::uint32_t i = 0; i < stage.instance_count(); ++i) {
      const Aabb always = stage.box_always(i);
      for (int n = 0; n < 5; ++n) {
        const double from = -20 + 110 * random.unit(),
                     to = from + std::exp(-9 + 12 * random.unit());
        const Aabb over = stage.box_over(i, from, to);
        for (int m = 0; m < 20; ++m, ++checked) {
          const double at = m == 0 ? from : m == 1 ? to : from + (to - from) * random.unit();
          if (!stage.is_shown(i, at)) {
            EXPECT_TRUE(stage.box_at(i, at).empty());
            continue;
          }
          ++shown;
          const BoxCheck check(stage, i, at);
          violations +=
              check.outside(stage.box_at(i, at)) + check.outside(over) + check.outside(always);
        }
      }
    }
  }
  EXPECT_EQ(violations, 0);
  EXPECT_GT(shown, checked / 2);
}

TEST(SceneBoxes, AreTight) {
  const std::vector<Model> models{test::random_points(200, 1)};
  const SceneStorage scene = test::random_scene(models, 2000, 100, 7);
  const Stage stage(scene.view(), models);
  double moment = 0, interval = 0, wanted = 0;
  for (std::uint32_t i = 0; i < stage.instance_count(); ++i) {
    const double at = 25;
    if (!stage.is_shown(i, at)) continue;
    // Relative to the vertices' box, so that large and small count alike.
    const Aabbd tight = BoxCheck(stage, i, at).tight();
    const double size = length(tight.extent());
    moment += diagonal(stage.box_at(i, at)) / size;
    interval += diagonal(stage.box_over(i, at, at + 1e-5)) / size;
    wanted += 1;
  }
  // A box around a turned box is larger than one around its content: 1.6 times where it is worst.
  EXPECT_LT(moment, 1.6 * wanted);
  EXPECT_LT(interval, 1.01 * moment);
}

TEST(SceneFaults, AreNamed) {
  const auto fault_of = [](auto&& spoil) {
    SceneStorage scene = one_instance({}, {turned_about_z(1, 0), turned_about_z(3, 0)});
    spoil(scene);
    return scene_fault(scene.view());
  };
  EXPECT_EQ(fault_of([](SceneStorage&) {}), "");
  const auto flat = fault_of([](SceneStorage& s) { s.instances[0].map.m[2][2] = 0; });
  EXPECT_NE(flat.find("instances: instance 0 is flat"), std::string::npos) << flat;
  EXPECT_NE(fault_of([](SceneStorage& s) { s.instances[0].map.m[0][3] = NAN; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.instances[0].start = INFINITY; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.instances[0].bits |= 1; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.instances[0].bits |= 3u << 29; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.labels[0].path = 1; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.labels.clear(); }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.roles[0].model = 1; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.paths[0].key_count = 3; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.paths[0].key_count = 1; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.paths[0].first_key = 1; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.paths[0].ends = PathEnds(3); }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.path_keys[1].time = 1; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.path_keys[1].scale.y = 0; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.path_keys[1].scale.y = -1; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.path_keys[1].scale = {1e-3f, 1, 1e3f}; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.path_keys[1].rotation[3] = 2; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.path_keys[1].translation.x = INFINITY; }), "");
  EXPECT_NE(fault_of([](SceneStorage& s) { s.last_time = -1; }), "");
}

}  // namespace
}  // namespace mdk
