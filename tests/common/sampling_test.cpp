// Several samples per pixel, in space and in time, and heat maps of what pictures cost.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "common/base/error.h"
#include "common/trace/color.h"
#include "common/trace/heat_map.h"
#include "common/trace/renderer.h"

namespace mdk {
namespace {

constexpr std::uint32_t kSide = 48;

/// A white, unlit square of side 2 in the plane z = 0, turned by `angle`, that moves by `path` from
/// its first key to its second one a second later.
ModelStorage square(float angle, const Vec3f& path) {
  ModelStorage m;
  m.vertex_count = 4;
  m.clips = {{"move", 0, 2}};
  m.key_times = {0, 1};
  const float c = std::cos(angle), s = std::sin(angle);
  for (const float key : {0.0f, 1.0f})
    for (const Vec3f& p : {Vec3f{-1, -1, 0}, Vec3f{1, -1, 0}, Vec3f{1, 1, 0}, Vec3f{-1, 1, 0}})
      m.poses.key_positions.push_back(Vec3f{c * p.x - s * p.y, s * p.x + c * p.y, 0} + path * key);
  for (const Vec3f& p : m.poses.key_positions) m.bounds.extend(p);
  m.rest_diagonal = std::sqrt(8.0);
  m.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  m.source_triangles = {0, 1};
  m.clusters.resize(1);
  m.clusters[0].triangle_count = 2;
  m.key_boxes = {m.bounds, m.bounds};
  m.cluster_world_boxes.assign(2, quantize_outward(m.bounds, m.bounds));
  m.local_from_world.resize(2);
  m.appearance.materials = {Material{.base_color = {1, 1, 1, 1}, .flags = kMaterialUnlit}};
  m.appearance.triangle_materials = {0, 0};
  return m;
}

/// Shows [-3, 3] squared, as good as parallel.
FrameRequest request_of(const KeyInterval& at) {
  FrameRequest request;
  request.at = at;
  request.camera = {.eye = {0, 0, 3000}, .target = {0, 0, 0}, .vertical_fov_deg = 0.11459155f};
  request.width = request.height = kSide;
  return request;
}

/// How much of each pixel is white, against the picture without any square.
std::vector<double> coverage(Renderer& renderer, const FrameRequest& request) {
  FrameRequest empty = request;
  empty.camera.eye = {1e4f, 0, 3000};
  empty.camera.target = {1e4f, 0, 0};
  renderer.render(empty);
  const std::vector<std::uint32_t> none(renderer.pixels().begin(), renderer.pixels().end());
  renderer.render(request);
  std::vector<double> shares;
  for (std::size_t i = 0; i < none.size(); ++i) {
    const double dark = static_cast<double>(linear_from_srgb(none[i]));
    const double light = static_cast<double>(linear_from_srgb(renderer.pixels()[i]));
    shares.push_back((light - dark) / (1 - dark));
  }
  return shares;
}

double total(const std::vector<double>& shares) {
  return std::accumulate(shares.begin(), shares.end(), 0.0);
}

TEST(Samples, CoverTheShareOfAPixelThatASquaresEdgeLeaves) {
  constexpr float kAngle = 0.3f;
  const ModelStorage storage = square(kAngle, {});
  const ModelView model = storage.view();
  Renderer renderer(model, "brute-force");
  FrameRequest request = request_of(at_key(0));
  constexpr double kUnit = kSide / 6.0;  // pixels
  const std::vector<double> one = coverage(renderer, request);
  request.samples = 16;
  const std::vector<double> many = coverage(renderer, request);
  EXPECT_NEAR(total(many), 4 * kUnit * kUnit, 0.004 * 4 * kUnit * kUnit);
  double worst = 0, worst_of_one = 0;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      constexpr int kFine = 32;
      int inside = 0;
      for (int i = 0; i < kFine * kFine; ++i) {
        const double px = (x + (i % kFine + 0.5) / kFine) / kUnit - 3;
        const double py = 3 - (y + (i / kFine + 0.5) / kFine) / kUnit;
        const double c = std::cos(double{kAngle}), s = std::sin(double{kAngle});
        inside += std::abs(c * px + s * py) < 1 && std::abs(-s * px + c * py) < 1;
      }
      const double exact = static_cast<double>(inside) / (kFine * kFine);
      const std::size_t i = std::size_t{y} * kSide + x;
      worst = std::max(worst, std::abs(many[i] - exact));
      worst_of_one = std::max(worst_of_one, std::abs(one[i] - exact));
    }
  EXPECT_LT(worst, 0.17);
  EXPECT_GT(worst_of_one, 0.4) << "one sample is all or nothing";
}

TEST(Samples, OneIsThePixelsCentreAndCountsAreOfAll) {
  const ModelStorage storage = square(0, {});
  const ModelView model = storage.view();
  Renderer renderer(model, "brute-force");
  FrameRequest request = request_of(at_key(0));
  renderer.render(request);
  const std::vector<std::uint32_t> one(renderer.pixels().begin(), renderer.pixels().end());
  EXPECT_EQ(renderer.stats().rays, std::uint64_t{kSide} * kSide);
  request.samples = 5;
  renderer.render(request);
  EXPECT_EQ(renderer.stats().rays, std::uint64_t{5} * kSide * kSide);
  EXPECT_EQ(renderer.pixels()[24 * kSide + 24], one[24 * kSide + 24]);
  request.samples = 1;
  renderer.render(request);
  EXPECT_TRUE(std::equal(one.begin(), one.end(), renderer.pixels().begin()));
}

TEST(Samples, ImpossibleNumbersAreRefused) {
  const ModelStorage storage = square(0, {});
  const ModelView model = storage.view();
  Renderer renderer(model, "brute-force");
  FrameRequest request = request_of(at_key(0));
  request.samples = 0;
  EXPECT_THROW(renderer.render(request), Error);
  request.samples = kMaxSamples + 1;
  EXPECT_THROW(renderer.render(request), Error);
  request.samples = 2;
  const std::vector<KeyInterval> one_moment = {at_key(0)};
  request.shutter = one_moment;
  EXPECT_THROW(renderer.render(request), Error);
  request.shutter = {};
  request.occlusion_rays = kMaxOcclusionRays + 1;
  EXPECT_THROW(renderer.render(request), Error);
}

TEST(Shutter, SpreadsItsMomentsEvenlyAroundTheFramesOwn) {
  const ModelStorage storage = square(0, {1, 0, 0});
  const ModelView model = storage.view();
  const std::vector<KeyInterval> moments = shutter_moments(model, 0, 0.5, 0.4, 32);
  ASSERT_EQ(moments.size(), 32u);
  EXPECT_EQ(moments[0], locate_time(model, 0, 0.5));
  std::vector<float> places;
  for (const KeyInterval& m : moments) places.push_back(m.s);
  std::sort(places.begin(), places.end());
  EXPECT_GE(places.front(), 0.3f);
  EXPECT_LE(places.back(), 0.7f);
  for (std::size_t i = 1; i < places.size(); ++i)
    EXPECT_LT(places[i] - places[i - 1], 3 * 0.4f / 32) << i;
  for (const KeyInterval& m : shutter_moments(model, 0, 0, 10, 8)) EXPECT_LE(m.s, 1);
}

TEST(Shutter, BlursAMovingSquareAlongItsPathByTheTimeItIsThere) {
  const ModelStorage storage = square(0, {2, 0, 0});
  const ModelView model = storage.view();
  Renderer renderer(model, "brute-force");
  FrameRequest request = request_of(locate_time(model, 0, 0.5));
  request.samples = 64;
  const std::vector<KeyInterval> moments = shutter_moments(model, 0, 0.5, 0.5, 64);
  request.shutter = moments;
  const std::vector<double> blurred = coverage(renderer, request);
  // From x = 0.5 to 1.5: its left edge sweeps [-0.5, 0.5], its right one [1.5, 2.5].
  for (const double x : {-0.25, 0.0, 0.25, 1.75, 2.0, 2.25}) {
    const auto column = static_cast<std::size_t>((x + 3) * kSide / 6);
    const double centre = (static_cast<double>(column) + 0.5) * 6 / kSide - 3;
    const double there = centre < 1 ? centre + 0.5 : 2.5 - centre;
    EXPECT_NEAR(blurred[24 * kSide + column], there, 0.05) << x;
  }
}

TEST(HeatColor, GrowsLighterAllTheWayAndClamps) {
  const auto luminance = [](double share) {
    const Vec3f c = heat_color(share);
    return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
  };
  for (int i = 0; i < 100; ++i) EXPECT_LT(luminance(i / 100.0), luminance((i + 1) / 100.0)) << i;
  EXPECT_EQ(heat_color(7), heat_color(1));
  EXPECT_EQ(heat_color(-7), heat_color(0));
  EXPECT_EQ(heat_color(std::nan("")), heat_color(0));
}

TEST(HeatScale, EndsAtTheNextRoundNumber) {
  EXPECT_DOUBLE_EQ(round_scale(0.31), 0.5);
  EXPECT_DOUBLE_EQ(round_scale(1), 1);
  EXPECT_DOUBLE_EQ(round_scale(1.01), 2);
  EXPECT_DOUBLE_EQ(round_scale(5001), 10000);
  EXPECT_DOUBLE_EQ(round_scale(0), 1);
}

TEST(HeatMap, ShowsTilesWhoseCountsAddUpToTheFramesCounters) {
  const ModelStorage storage = square(0.3f, {});
  const ModelView model = storage.view();
  Renderer renderer(model, "refit-bvh");
  FrameRequest request = request_of(at_key(0));
  request.counting = Counting::kOn;
  const TraceCounters counted = renderer.trace(request).counters;
  EXPECT_GT(counted.triangle_tests, 0u);
  request.counting = Counting::kOff;
  request.shading = ShadingMode::kTests;
  const FrameStats& stats = renderer.render(request);
  EXPECT_EQ(stats.counters, TraceCounters{}) << "the timed picture counts nothing";
  TraceCounters sum;
  for (const TraceCounters& tile : renderer.tile_work()) sum += tile;
  EXPECT_EQ(sum, counted);
  EXPECT_EQ(renderer.heat_scale().unit, "tests per ray");
  double largest = 0;
  for (const TraceCounters& tile : renderer.tile_work())
    largest = std::max(largest, static_cast<double>(tile.triangle_tests) / kTilePixels);
  EXPECT_DOUBLE_EQ(renderer.heat_scale().top, round_scale(largest));
  request.shading = ShadingMode::kDiffuse;
  renderer.render(request);
  EXPECT_EQ(renderer.heat_scale(), HeatScale{});
}

TEST(Residuals, AreTheMotionThatTheMapDoesNotExplainRelativeToTheRestDiagonal) {
  // The square moves by (0.3, 0, 0); the map follows two thirds of the way.
  ModelStorage storage = square(0, {0.3f, 0, 0});
  storage.local_from_world[1].m[0][3] = -0.2f;
  const ModelView model = storage.view();
  PosedMesh mesh(model);
  std::vector<float> residuals(2);
  mesh.set_time(at_key(0));
  triangle_residuals(mesh, residuals);
  EXPECT_EQ(residuals[0], 0);
  mesh.set_time(at_key(1));
  triangle_residuals(mesh, residuals);
  for (const float r : residuals) EXPECT_NEAR(r, 0.1 / std::sqrt(8.0), 1e-6);

  HeatMap map;
  const HeatScale scale = map.color_triangles(mesh);
  EXPECT_DOUBLE_EQ(scale.top, 5);  // 3.5 % of the diagonal
  const std::uint32_t color = map.triangle_colors()[0];
  EXPECT_NEAR(color / 255.0, 3.5355 / 5, 0.01);
  EXPECT_EQ(map.palette()[color], heat_color(color / 255.0));
}

}  // namespace
}  // namespace mdk
