// The kernels against brute force where rounding is all there is: slivers and sheets seen edge-on,
// pictures whose pixels are smaller than the coordinates' last bit, hits in front of what is
// culled.
#include "common/trace/kernels/tile_kernels.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

#include "common/base/isa.h"
#include "common/structures/kd_tree.h"
#include "common/trace/cluster_trees.h"

namespace mdk {
namespace {

constexpr std::uint32_t kWidth = 48, kHeight = 64;

/// A few triangles of their own corners, traced by brute force and through structures with one
/// triangle per leaf, so that every culling decision counts.
class Trial {
 public:
  void add(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    const auto first = static_cast<std::uint32_t>(positions_.size());
    triangles_.push_back({{first, first + 1, first + 2}});
    positions_.insert(positions_.end(), {a, b, c});
    Aabb box;
    for (const Vec3f& p : {a, b, c}) box.extend(p);
    boxes_.push_back(box);
  }

  /// Pixels where a structure's hit is not brute force's.
  int mismatches(const Camera& camera) {
    const PinholeRays rays = make_pinhole_rays(camera, kWidth, kHeight);
    const PixelFromWorld pixel_from_world = make_pixel_from_world(rays);
    const auto level = [&](const auto& tree, const Aabb& bounds) {
      TreeLevel<std::decay_t<decltype(tree)>> result{};
      result.tree = tree;
      result.forms = make_frustum_forms(rays, Affine3d{}, bounds);
      return result;
    };
    const WideBvh bvh = collapse(build_bvh(boxes_, {.max_leaf = 1}));
    std::vector<TriangleBlock> blocks;
    append_blocks(bvh, triangles_, 0, blocks);
    EXPECT_EQ(validate(blocks, triangles_), "");
    ProjectionCache cache;
    cache.begin_frame(blocks.size());
    const KdTree kd = build_kd_tree(boxes_, 0, {.intersect_cost = 50.0f});
    TraceScene scenes[4];  // all triangles, a hierarchy, one that keeps its blocks, a kd-tree
    for (TraceScene& scene : scenes) {
      scene.triangles = triangles_.data();
      scene.triangle_count = static_cast<std::uint32_t>(triangles_.size());
      scene.positions = positions_.data();
      scene.blocks = blocks;
    }
    scenes[1].structure = BvhLevels{level(BvhView{bvh.nodes, 0}, bvh.nodes[0].box()), {}, {}};
    scenes[2].structure = scenes[1].structure;
    scenes[2].projected_blocks = &cache;
    scenes[3].structure = KdLevels{level(kd.view(), kd.bounds), {}, {}};
    for (HitBuffer& hits : hits_) hits.resize(kTileSide, kTileSide);
    int different = 0;
    for (std::uint32_t y = 0; y < kHeight; y += kTileSide)
      for (std::uint32_t x = 0; x < kWidth; x += kTileSide) {
        const TileRays tile{&rays, &pixel_from_world, x, y};
        for (std::size_t k = 0; k < 4; ++k)
          hits_[k].set_hit(0, trace_tile(tile, scenes[k], hits_[k].tile(0), scratch_, nullptr));
        hit_count_ += static_cast<int>(count_hits(hits_[0]));
        for (std::size_t k = 1; k < 4; ++k)
          different += static_cast<int>(count_mismatches(hits_[0], hits_[k]));
      }
    return different;
  }

  int hit_count() const { return hit_count_; }

 private:
  std::vector<Triangle> triangles_;
  std::vector<Vec3f> positions_;
  std::vector<Aabb> boxes_;
  std::array<HitBuffer, 4> hits_;  ///< of one tile
  TileScratch scratch_;
  int hit_count_ = 0;
};

class TileKernels : public testing::TestWithParam<std::string_view> {
 protected:
  void SetUp() override { limit_isa(GetParam()); }
  void TearDown() override { reset_isa(); }

  float unit() { return distribution_(random_); }
  float between(float a, float b) { return a + (b - a) * (0.5f + 0.5f * unit()); }

 private:
  std::mt19937 random_{2026};
  std::uniform_real_distribution<float> distribution_{-1, 1};
};

TEST_P(TileKernels, TrianglesInThePlaneOfAPixelColumnHitOnlyWhereTheirBoxIs) {
  const Camera camera{.eye = {0, 0, 0}, .target = {0, 0, -1}, .vertical_fov_deg = 60};
  const PinholeRays rays = make_pinhole_rays(camera, kWidth, kHeight);
  int mismatches = 0;
  for (int i = 0; i < 3000; ++i) {
    const float column = std::floor(between(0, kWidth)) + 0.5f;
    const auto on_column = [&](float row, float depth) {
      return rays.direction(column, row) * depth;
    };
    const float row = between(0, kHeight), reach = between(0.1f, 12);
    Trial trial;
    for (int k = 0; k < 6; ++k)
      trial.add(on_column(row + reach * unit(), between(1, 5)),
                on_column(row + reach * unit(), between(1, 5)),
                on_column(row + reach * unit(), between(1, 5)));
    mismatches += trial.mismatches(camera);
  }
  EXPECT_EQ(mismatches, 0);
}

TEST_P(TileKernels, SliversThatReachBehindTheEyeHitOnlyWhereTheirBoxIs) {
  int mismatches = 0;
  for (int i = 0; i < 3000; ++i) {
    const Camera camera{.eye = {unit(), unit(), unit()},
                        .target = {unit(), unit(), unit()},
                        .vertical_fov_deg = between(20, 160)};
    const PinholeRays rays = make_pinhole_rays(camera, kWidth, kHeight);
    const float column = std::floor(between(0, kWidth)) + 0.5f;
    Trial trial;
    for (int k = 0; k < 6; ++k) {
      const auto corner = [&] {
        return rays.origin + rays.direction(column, kHeight * unit()) * (3 * unit());
      };
      const Vec3f a = corner(), b = corner();
      trial.add(a, b, k % 2 == 0 ? corner() : a + (b - a) * unit());
    }
    mismatches += trial.mismatches(camera);
  }
  EXPECT_EQ(mismatches, 0);
}

TEST_P(TileKernels, HitsOfSheetsSeenEdgeOnStayWithinTheirDepth) {
  const Camera camera{.eye = {0, 0, 0}, .target = {0, 0, -1}, .vertical_fov_deg = 60};
  const PinholeRays rays = make_pinhole_rays(camera, kWidth, kHeight);
  int mismatches = 0, hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const float column = std::floor(between(0, kWidth)) + 0.5f;
    Trial trial;
    const float wall = between(2, 6);  // in front of some of what follows
    trial.add(rays.direction(-100, -100) * wall, rays.direction(200, -100) * wall,
              rays.direction(20, 300) * wall);
    for (int k = 0; k < 6; ++k) {
      const float row = between(0, kHeight), depth = wall * between(0.9f, 1.1f);
      const auto near_column = [&] {
        return rays.direction(column + 1e-6f * unit(), row + 3 * unit()) *
               (depth * between(1, 1.02f));
      };
      trial.add(near_column(), near_column(), near_column());
    }
    mismatches += trial.mismatches(camera);
    hits += trial.hit_count();
  }
  EXPECT_EQ(mismatches, 0);
  EXPECT_GT(hits, 0);
}

TEST_P(TileKernels, PixelsSmallerThanTheCoordinatesLastBitLoseNoHit) {
  int mismatches = 0, hits = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3f far{1e6f * unit(), 1e6f * unit(), 1e6f * unit()};
    const auto nearby = [&](float size) {
      return far + Vec3f{size * unit(), size * unit(), size * unit()};
    };
    const Camera camera{.eye = nearby(20), .target = far, .vertical_fov_deg = between(0.05f, 3)};
    if (camera.eye == camera.target) continue;
    Trial trial;
    for (int k = 0; k < 8; ++k) trial.add(nearby(1), nearby(1), nearby(1));
    mismatches += trial.mismatches(camera);
    hits += trial.hit_count();
  }
  EXPECT_EQ(mismatches, 0);
  EXPECT_GT(hits, 10000);
}

TEST_P(TileKernels, TrianglesAroundTheEyeAreHitInFrontOnly) {
  int mismatches = 0, hits = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto point = [&] { return Vec3f{unit(), unit(), unit()}; };
    const Camera camera{
        .eye = point() * 0.2f, .target = point(), .vertical_fov_deg = between(5, 170)};
    Trial trial;
    for (int k = 0; k < 12; ++k) trial.add(point(), point(), point());
    mismatches += trial.mismatches(camera);
    hits += trial.hit_count();
  }
  EXPECT_EQ(mismatches, 0);
  EXPECT_GT(hits, 10000);
}

TEST_P(TileKernels, CornersThatAreNotNumbersAreNeverHit) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const Camera camera{.eye = {0, 0, 3}, .target = {0, 0, 0}};
  const PinholeRays rays = make_pinhole_rays(camera, kWidth, kHeight);
  const PixelFromWorld pixel_from_world = make_pixel_from_world(rays);
  for (const float bad : {nan, inf, -inf}) {
    const std::vector<Vec3f> positions = {{bad, 0, 0}, {1, -1, 0}, {-1, -1, 0}, {0, bad, bad}};
    const std::vector<Triangle> triangles = {{{0, 1, 2}}, {{1, 0, 2}}, {{3, 1, 2}}, {{0, 0, 3}}};
    TraceScene scene;
    scene.triangles = triangles.data();
    scene.triangle_count = 4;
    scene.positions = positions.data();
    TileHits hits;
    TileScratch scratch;
    const TileRays tile{&rays, &pixel_from_world, 16, 32};
    EXPECT_FALSE(trace_tile(tile, scene, hits, scratch, nullptr));
  }
}

INSTANTIATE_TEST_SUITE_P(Isas, TileKernels, testing::ValuesIn(available_isas()),
                         [](const auto& param) { return std::string(param.param); });

}  // namespace
}  // namespace mdk
