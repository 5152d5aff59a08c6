// Pictures of scenes: whatever way an instance is traced, its pixels are those of brute force over
// all triangles of all instances, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/base/parallel.h"
#include "common/motion/model_handle.h"
#include "common/trace/scene_renderer.h"
#include "tests/agreement/test_scenes.h"
#include "tests/common/random_scene.h"

namespace mdk {
namespace {

using test::ResetIsa;

/// Three models of their own kinds, baked once.
const std::vector<Model>& models() {
  static const std::vector<Model> all = [] {
    std::vector<Model> made;
    for (PoseSequence sequence : {test::bending_tube(16, 12, 7), test::twisting_sphere(3, 5),
                                  test::random_triangles(120, 6, 1, 0)}) {
      auto baked = std::make_shared<DecomposeResult>(test::bake(std::move(sequence)));
      auto view = std::make_shared<const ModelView>(baked->model.view());
      made.push_back(ModelHandle::make(
          *view, std::make_shared<
                     std::pair<std::shared_ptr<DecomposeResult>, std::shared_ptr<const ModelView>>>(
                     baked, view)));
    }
    return made;
  }();
  return all;
}

/// Around the crowd, inside of it, close to one of it, and through a keyhole.
std::vector<Camera> cameras_for(const Stage& stage, float reach, double time, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto in = [&](float a, float b) {
    return std::uniform_real_distribution<float>(a, b)(random);
  };
  Camera far, inside, close, keyhole;
  far.eye = {0.3f * reach, 0.9f * reach, 2.6f * reach};
  far.vertical_fov_deg = 60;
  inside.eye = {in(-.4f, .4f) * reach, in(-.4f, .4f) * reach, in(-.4f, .4f) * reach};
  inside.target = {in(-1, 1) * reach, in(-1, 1) * reach, in(-1, 1) * reach};
  inside.vertical_fov_deg = 100;
  const Aabb box = stage.box_at(random() % stage.instance_count(), time);
  if (!box.empty()) {
    close.target = box.center();
    close.eye = close.target + Vec3f{.4f, .7f, 1} * std::max(diagonal(box), 1e-3f);
  }
  keyhole = far;
  keyhole.target = inside.eye;
  keyhole.vertical_fov_deg = 4;
  return {far, inside, close, keyhole};
}

constexpr SceneOptions kBrute{.technique = SceneTechnique::kBruteForce};

constexpr SceneOptions kRefit{.technique = SceneTechnique::kRefit};

SceneOptions with_lines(float share) { return {.line_share = share}; }

struct Crowd {
  SceneStorage storage;
  Stage stage;

  Crowd(std::uint32_t instances, float reach, std::uint64_t seed)
      : storage(test::random_scene(models(), instances, reach, seed)),
        stage(storage.view(), models()) {}
};

TEST(CrowdAgreement, GivesBruteForcesPixelsWhateverTheCrowd) {
  std::uint64_t hits = 0;
  std::uint32_t seed = 0;
  for (const std::uint32_t instances : {2u, 3u, 7u, 20u, 60u, 300u})
    for (const float reach : {4.0f, 40.0f, 400.0f}) {
      const Crowd crowd(instances, reach, ++seed);
      SceneRenderer oracle(crowd.stage, kBrute);
      // As it chooses itself, all instances as frusta, all that may as lines, and a mixture.
      SceneRenderer ways[] = {SceneRenderer(crowd.stage), SceneRenderer(crowd.stage, with_lines(0)),
                              SceneRenderer(crowd.stage, with_lines(1e9f)),
                              SceneRenderer(crowd.stage, with_lines(2)),
                              SceneRenderer(crowd.stage, kRefit)};
      const double time = 60 * std::fmod(seed * 0.618, 1.0);
      for (const Camera& camera : cameras_for(crowd.stage, reach, time, seed)) {
        SceneRequest request;
        request.time = time;
        request.camera = camera;
        request.width = 83;
        request.height = 61;
        hits += oracle.trace(request).hits;
        for (SceneRenderer& renderer : ways) {
          renderer.trace(request);
          EXPECT_EQ(count_mismatches(oracle.hits(), renderer.hits()), 0u)
              << "way " << &renderer - ways << ", " << instances << " within " << reach << ", seed "
              << seed << ", eye " << camera.eye.x << " " << camera.eye.y << " " << camera.eye.z;
        }
      }
    }
  EXPECT_GT(hits, 50'000u);
}

/// Sheets whose planes all hold the eye: their edge functions are nothing but rounding.
TEST(CrowdAgreement, HoldsForSheetsSeenEdgeOn) {
  auto baked = std::make_shared<DecomposeResult>(test::bake(test::edge_on_sheet(60, 3)));
  auto view = std::make_shared<const ModelView>(baked->model.view());
  const std::vector<Model> sheet = {ModelHandle::make(*view, view)};
  const float size = diagonal(view->bounds);
  SceneRequest request;
  request.camera = {.eye = {3, 1, 2}, .target = {4, 2, -20}, .vertical_fov_deg = 60};
  request.width = request.height = 200;
  request.time = 0.1;
  std::uint64_t hits = 0;
  for (const float scale : {0.02f, 0.1f, 0.4f, 2.0f}) {
    SceneStorage storage;
    storage.model_count = 1;
    storage.roles = {{0, 0}};
    std::mt19937 random(5);
    std::uniform_real_distribution<float> in(-1, 1);
    for (int i = 0; i < 300; ++i) {
      SceneInstance& instance = storage.instances.emplace_back();
      storage.labels.emplace_back();
      // Through the centres of a column or a row of pixels.
      const PinholeRays rays = make_pinhole_rays(request.camera, request.width, request.height);
      const Vec3f way = rays.direction(static_cast<float>(random() % 200) + 0.5f,
                                       static_cast<float>(random() % 200) + 0.5f);
      const Vec3f at = rays.origin + way * (20 + 6 * in(random));
      const Vec3f z = normalized(way), x = normalized(cross(z, i % 2 == 0 ? rays.dv : rays.du)),
                  y = cross(z, x);
      for (std::size_t row = 0; row < 3; ++row) {
        instance.map.m[row][0] = x[row] * scale / size;
        instance.map.m[row][1] = y[row] * scale / size;
        instance.map.m[row][2] = z[row] * scale / size;
        instance.map.m[row][3] = at[row];
      }
    }
    const Stage stage(storage.view(), sheet);
    SceneRenderer oracle(stage, kBrute);
    hits += oracle.trace(request).hits;
    for (const float share : {0.0f, 1e9f}) {
      SceneRenderer renderer(stage, with_lines(share));
      renderer.trace(request);
      EXPECT_EQ(count_mismatches(oracle.hits(), renderer.hits()), 0u)
          << "scale " << scale << ", lines " << share;
    }
  }
  EXPECT_GT(hits, 300u);
}

TEST(CrowdAgreement, LinesAndFrustaAreBothTaken) {
  const Crowd crowd(60, 40, 4);
  SceneRequest request;
  request.camera = cameras_for(crowd.stage, 40, 0, 1)[0];
  request.width = request.height = 100;
  request.counting = true;
  SceneRenderer lines(crowd.stage, with_lines(1e9f)), frusta(crowd.stage, with_lines(0));
  lines.trace(request);
  EXPECT_GT(lines.stats().counters.lines, 1000u);
  frusta.trace(request);
  EXPECT_EQ(frusta.stats().counters.lines, 0u);
  EXPECT_GT(frusta.stats().counters.instances_entered, 100u);
}

TEST(CrowdAgreement, DoesNotDependOnInstructionSetOrThreads) {
  const ResetIsa reset;
  const Crowd crowd(120, 30, 77);
  SceneRequest request;
  request.camera = cameras_for(crowd.stage, 30, 7.7, 3)[0];
  request.time = 7.7;
  request.width = 150;
  request.height = 100;
  SceneRenderer oracle(crowd.stage, kBrute);
  ASSERT_GT(oracle.trace(request).hits, 1000u);
  SceneRenderer first(crowd.stage);
  first.render(request);
  const std::vector<std::uint32_t> picture(first.pixels().begin(), first.pixels().end());
  for (const std::string_view isa : available_isas())
    for (const int threads : {1, 2}) {
      limit_isa(isa);
      const ThreadLimit limit(threads);
      SceneRenderer renderer(crowd.stage);
      renderer.render(request);
      EXPECT_EQ(count_mismatches(oracle.hits(), renderer.hits()), 0u) << isa << " " << threads;
      EXPECT_TRUE(std::ranges::equal(picture, renderer.pixels())) << isa << " " << threads;
    }
}

TEST(CrowdAgreement, DoesNotDependOnTheCacheOrOnFramesBefore) {
  const Crowd crowd(200, 20, 5);
  SceneRenderer roomy(crowd.stage), tight(crowd.stage, {.cache_bytes = 0});
  for (const double time : {3.0, 41.0, 3.5}) {
    SceneRequest request;
    request.time = time;
    request.camera = cameras_for(crowd.stage, 20, time, 9)[0];
    request.width = request.height = 90;
    SceneRenderer oracle(crowd.stage, kBrute);
    EXPECT_GT(oracle.trace(request).hits, 100u);
    roomy.trace(request);
    tight.trace(request);
    EXPECT_EQ(count_mismatches(oracle.hits(), roomy.hits()), 0u) << time;
    EXPECT_EQ(count_mismatches(oracle.hits(), tight.hits()), 0u) << time;
  }
}

TEST(CrowdAgreement, TiesGoToTheLowerInstance) {
  SceneStorage storage;
  storage.model_count = 3;
  storage.roles = {{1, 0}};
  storage.instances.resize(9);
  storage.labels.resize(9);
  const Stage stage(storage.view(), models());
  SceneRenderer renderer(stage);
  SceneRequest request;
  request.camera = fit_camera(stage.box_always(0), 1);
  for (const std::uint32_t side : {8u, 40u, 400u}) {
    request.width = request.height = side;
    ASSERT_GT(renderer.trace(request).hits, 10u);
    for (std::uint32_t y = 0; y < side; ++y)
      for (std::uint32_t x = 0; x < side; ++x) {
        const std::uint32_t instance = renderer.hits().instance(x, y);
        EXPECT_TRUE(instance == 0 || instance == kNoHit) << instance;
      }
  }
}

TEST(CrowdAgreement, RefusesModesThatScenesHaveNot) {
  const Crowd crowd(2, 4, 1);
  SceneRenderer renderer(crowd.stage);
  SceneRequest request;
  request.shading = ShadingMode::kLit;
  EXPECT_THROW(renderer.render(request), Error);
}

}  // namespace
}  // namespace mdk
