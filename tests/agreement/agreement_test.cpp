// The promise everything else rests on: every technique gives brute force's closest hit, bit for
// bit, with any instruction set and any number of threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "common/base/isa.h"
#include "common/base/parallel.h"
#include "common/trace/renderer.h"
#include "preprocess/pipeline.h"
#include "tests/agreement/test_scenes.h"

namespace mdk {
namespace {

using test::bake;
using test::ResetIsa;

/// From outside, close by, inside, along an axis, through a keyhole, and very wide.
std::vector<Camera> cameras_for(const Aabb& bounds) {
  const Vec3f center = bounds.center();
  const float size = std::max(diagonal(bounds), 1e-12f);
  Camera fit = fit_camera(bounds, 1.0), close = fit, inside = fit, axis = fit, keyhole = fit,
         wide = fit;
  close.eye = center + (fit.eye - center) * 0.6f;
  inside.eye = center + Vec3f{0.013f, 0.021f, 0.017f} * size;
  inside.target = center + Vec3f{1, 0.2f, -0.5f} * size;
  axis.eye = {center.x, center.y, center.z + 2 * size};
  keyhole.vertical_fov_deg = 2;
  wide.eye = inside.eye;
  wide.target = bounds.hi;
  wide.vertical_fov_deg = 150;
  return {fit, close, inside, axis, keyhole, wide};
}

std::vector<KeyInterval> moments_of(const ModelView& model) {
  std::vector<KeyInterval> moments = {at_key(0), at_key(model.key_count() - 1)};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> when(0, model.clip_seconds(model.clips[0]));
  for (int i = 0; i < 3; ++i) moments.push_back(locate_time(model, 0, when(random)));
  return moments;
}

TEST(Agreement, EveryTechniqueOfOursGivesBruteForcesHitsOnEveryScene) {
  for (auto& [name, sequence] : test::agreement_scenes()) {
    const DecomposeResult baked = bake(std::move(sequence));
    const ModelView model = baked.model.view();
    Renderer oracle(model, "brute-force"), renderer(model, "brute-force");
    std::uint64_t hits = 0;
    for (const Camera& camera : cameras_for(model.bounds))
      for (const KeyInterval& at : moments_of(model)) {
        const FrameRequest request{.at = at, .camera = camera, .width = 75, .height = 61};
        hits += oracle.trace(request).hits;
        for (const TechniqueInfo& technique : technique_table()) {
          if (technique.kind == TechniqueKind::kPeer) continue;
          renderer.set_technique(technique.id);
          renderer.trace(request);
          EXPECT_EQ(count_mismatches(oracle.hits(), renderer.hits()), 0u)
              << name << ", " << technique.id << ", keys " << at.key0 << "-" << at.key1 << " at "
              << at.s << ", eye " << camera.eye.x << " " << camera.eye.y << " " << camera.eye.z;
        }
      }
    EXPECT_GT(hits, 0u) << name << ": the cameras see nothing, so the test proves nothing";
  }
}

TEST(Agreement, HoldsInEveryTimeSegmentAndAtTheCuts) {
  DecomposeOptions options;
  options.segments = 4;
  SilentProgress silent;
  const DecomposeResult baked = decompose(test::bending_tube(30, 16, 13), options, silent);
  const ModelView model = baked.model.view();
  ASSERT_EQ(model.segment_count(), 4u);
  Renderer oracle(model, "brute-force"), renderer(model, "brute-force");
  const auto expect_agreement = [&](const KeyInterval& at) {
    const FrameRequest request{
        .at = at, .camera = fit_camera(model.bounds, 1.0), .width = 75, .height = 61};
    EXPECT_GT(oracle.trace(request).hits, 0u);
    for (const TechniqueInfo& technique : technique_table()) {
      if (technique.kind == TechniqueKind::kPeer) continue;
      renderer.set_technique(technique.id);
      renderer.trace(request);
      EXPECT_EQ(count_mismatches(oracle.hits(), renderer.hits()), 0u)
          << technique.id << ", keys " << at.key0 << "-" << at.key1 << " at " << at.s;
    }
  };
  // Back and forth, so that trees are swapped in both directions.
  for (std::uint32_t i = 0; i + 1 < model.key_count(); ++i) {
    const std::uint32_t key = i % 2 == 0 ? i / 2 : model.key_count() - 2 - i / 2;
    expect_agreement(at_key(key));
    expect_agreement({key, key + 1, 0x1p-20f});
    expect_agreement({key, key + 1, 0.6f});
    expect_agreement({key, key + 1, 0x1.fffffep-1f});
  }
}

TEST(Agreement, HitsAndCountsDoNotDependOnInstructionSetOrThreads) {
  const ResetIsa reset;
  const DecomposeResult baked = bake(test::bending_tube(40, 24, 12));
  const ModelView model = baked.model.view();
  const FrameRequest request{.at = locate_time(model, 0, 0.111),
                             .camera = fit_camera(model.bounds, 1.5),
                             .width = 150,
                             .height = 100,
                             .counting = Counting::kOn};
  for (const TechniqueInfo& technique : technique_table()) {
    if (technique.kind == TechniqueKind::kPeer) continue;
    reset_isa();
    Renderer reference(model, technique.id);
    const FrameStats expected = reference.render(request);
    EXPECT_GT(expected.hits, 0u);
    for (const std::string_view isa : available_isas())
      for (const int threads : {1, 2, 5}) {
        limit_isa(isa);
        EXPECT_EQ(isa_in_use(), isa);
        const ThreadLimit limit(threads);
        Renderer renderer(model, technique.id);
        const FrameStats got = renderer.render(request);
        EXPECT_EQ(count_mismatches(reference.hits(), renderer.hits()), 0u)
            << technique.id << " " << isa << " " << threads;
        EXPECT_TRUE(std::ranges::equal(reference.pixels(), renderer.pixels()))
            << technique.id << " " << isa << " " << threads;
        EXPECT_GT(got.counters.leaf_triangles, 0u);
        EXPECT_GT(got.counters.triangle_tests, 0u);
        if (technique.kind == TechniqueKind::kAdaptive) continue;  // it chooses by the clock
        EXPECT_EQ(got.counters.node_visits, expected.counters.node_visits)
            << technique.id << " " << isa << " " << threads;
        EXPECT_EQ(got.counters.leaf_triangles, expected.counters.leaf_triangles)
            << technique.id << " " << isa << " " << threads;
        EXPECT_EQ(got.counters.triangle_tests, expected.counters.triangle_tests)
            << technique.id << " " << isa << " " << threads;
        EXPECT_EQ(got.counters.clusters_entered, expected.counters.clusters_entered)
            << technique.id << " " << isa << " " << threads;
      }
  }
}

TEST(Agreement, CountsDependOnTheFramesBeforeWhereTheTableSaysSoOnly) {
  DecomposeOptions options;
  options.rest_key = 0;  // where all are together, so that their hierarchy wears out
  SilentProgress silent;
  const DecomposeResult baked = decompose(test::flying_boxes(30, 12), options, silent);
  const ModelView model = baked.model.view();
  FrameRequest request{.at = at_key(0),
                       .camera = fit_camera(model.bounds, 1.5),
                       .width = 150,
                       .height = 100,
                       .counting = Counting::kOn};
  for (const TechniqueInfo& technique : technique_table()) {
    if (technique.kind == TechniqueKind::kPeer || technique.kind == TechniqueKind::kAdaptive)
      continue;
    Renderer fresh(model, technique.id), worn(model, technique.id);
    for (std::uint32_t i = 0; i < 40; ++i) {  // a long stay where all has flown apart
      request.at = at_key(model.key_count() - 1 - i % 2);
      worn.trace(request);
    }
    request.at = at_key(1);
    const bool is_same = worn.trace(request).counters == fresh.trace(request).counters;
    EXPECT_EQ(is_same, technique.kind != TechniqueKind::kHistory) << technique.id;
    EXPECT_EQ(count_mismatches(worn.hits(), fresh.hits()), 0u) << technique.id;
  }
}

/// Möller and Trumbore's test in double: another formula, another precision, no tiles.
bool hit_in_double(const Vec3d& origin, const Vec3d& d, const Vec3d (&v)[3], double& t) {
  const Vec3d e1 = v[1] - v[0], e2 = v[2] - v[0], p = cross(d, e2);
  const double det = dot(e1, p);
  if (det == 0) return false;
  const Vec3d s = origin - v[0], q = cross(s, e1);
  const double u = dot(s, p) / det, w = dot(d, q) / det;
  t = dot(e2, q) / det;
  return u >= 0 && w >= 0 && u + w <= 1 && t > 0;
}

TEST(Agreement, BruteForceAgreesWithAnIndependentTestInDoubleButForEdges) {
  const DecomposeResult baked = bake(test::bending_tube(20, 16, 4));
  const ModelView model = baked.model.view();
  const Camera camera = fit_camera(model.bounds, 1.0);
  constexpr std::uint32_t kSide = 128;
  Renderer renderer(model, "brute-force");
  renderer.trace({.at = at_key(2), .camera = camera, .width = kSide, .height = kSide});
  const PinholeRays rays = make_pinhole_rays(camera, kSide, kSide);
  PosedMesh mesh(model);
  mesh.set_time(at_key(2));

  int different = 0, hits = 0;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) {
      const Vec3d d =
          to_double(rays.corner) + to_double(rays.du) * (x + 0.5) + to_double(rays.dv) * (y + 0.5);
      double best = std::numeric_limits<double>::infinity();
      for (const Triangle& triangle : model.triangles) {
        Vec3d v[3];
        for (int k = 0; k < 3; ++k) v[k] = to_double(mesh.positions()[triangle.v[k]]);
        double t = 0;
        if (hit_in_double(to_double(rays.origin), d, v, t)) best = std::min(best, t);
      }
      const bool hit = renderer.hits().triangle(x, y) != kNoHit;
      hits += hit;
      const bool same = hit == std::isfinite(best) &&
                        (!hit || std::abs(renderer.hits().t(x, y) - best) < 1e-4 * best);
      different += !same;
    }
  EXPECT_GT(hits, 400);
  EXPECT_LE(different, 3);
}

/// How many vertices the technique had posed to show the mesh between two keys, lit or not.
std::size_t posed_to_show(const ModelView& model, std::string_view id, const Camera& camera) {
  PosedMesh mesh(model);
  mesh.set_time({0, 1, 0.5f});
  const std::unique_ptr<Technique> technique = find_technique(id).make(model);
  const PinholeRays rays = make_pinhole_rays(camera, 128, 128);
  const PixelFromWorld map = make_pixel_from_world(rays);
  technique->prebuild(mesh);
  technique->update(mesh);
  technique->set_view(rays);
  TileScratch scratch;
  HitBuffer hits;
  hits.resize(128, 128);
  for (std::size_t i = 0; i < hits.tile_count(); ++i) {
    const TileRays tile{&rays, &map, hits.tile_left(i), hits.tile_top(i)};
    hits.set_hit(i, technique->trace(tile, hits.tile(i), scratch, nullptr));
  }
  return mesh.posed_count();
}

TEST(Agreement, FuzzyStructuresPoseOnlyWhatRaysComeNear) {
  const DecomposeResult baked = bake(test::bending_tube(120, 24, 6));
  const ModelView model = baked.model.view();
  ASSERT_GT(model.cluster_count(), 3u);
  const Camera whole = fit_camera(model.bounds, 1.0);
  Camera away = whole, end = whole;
  away.target = whole.eye + (whole.eye - whole.target);
  end.target = model.world_box(0, 0).center();
  end.vertical_fov_deg = 4;
  for (const char* id : {"fuzzy-bvh", "fuzzy-kdtree"}) {
    EXPECT_EQ(posed_to_show(model, id, away), 0u) << id;
    EXPECT_LT(posed_to_show(model, id, end), model.vertex_count) << id;
    EXPECT_GT(posed_to_show(model, id, end), 0u) << id;
    EXPECT_GT(posed_to_show(model, id, whole), model.vertex_count / 3) << id;
  }
  EXPECT_EQ(posed_to_show(model, "refit-bvh", away), model.vertex_count);
}

TEST(Agreement, PicturesDoNotDependOnWhatWasPosedBefore) {
  const DecomposeResult baked = bake(test::bending_tube(120, 24, 6));
  const ModelView model = baked.model.view();
  FrameRequest close;
  close.camera = fit_camera(model.bounds, 1.0);
  close.width = close.height = 96;
  close.camera.target = model.world_box(0, 0).center();
  close.camera.vertical_fov_deg = 4;
  FrameRequest whole = close;
  whole.camera = fit_camera(model.bounds, 1.0);
  Renderer wandering(model, "fuzzy-bvh");
  for (const float s : {0.25f, 0.5f})
    for (const ShadingMode mode : {ShadingMode::kDiffuse, ShadingMode::kNormals, ShadingMode::kLit})
      for (FrameRequest request : {close, whole, close}) {
        request.at = {0, 1, s};
        request.shading = mode;
        wandering.render(request);
        Renderer judge(model, "brute-force");
        judge.render(request);
        EXPECT_TRUE(std::ranges::equal(wandering.pixels(), judge.pixels()));
      }
}

TEST(Agreement, ClosedMeshShowsNoCracks) {
  // Between the silhouette's ends of every row of pixels a convex closed body has no gap.
  PoseSequence tube = test::bending_tube(60, 48, 1);
  const DecomposeResult baked = bake(std::move(tube));
  const ModelView model = baked.model.view();
  Camera camera = fit_camera(model.bounds, 1.0);
  camera.eye = model.bounds.center() + Vec3f{0, 0, 6};
  Renderer renderer(model, "fuzzy-kdtree");
  constexpr std::uint32_t kSide = 512;
  renderer.trace({.at = at_key(0), .camera = camera, .width = kSide, .height = kSide});
  int gaps = 0, rows = 0;
  for (std::uint32_t y = 0; y < kSide; ++y) {
    std::uint32_t first = kSide, last = 0, count = 0;
    for (std::uint32_t x = 0; x < kSide; ++x) {
      if (renderer.hits().triangle(x, y) == kNoHit) continue;
      first = std::min(first, x);
      last = x;
      ++count;
    }
    if (count == 0) continue;
    ++rows;
    gaps += static_cast<int>(last - first + 1 - count);
  }
  EXPECT_GT(rows, 200);
  EXPECT_EQ(gaps, 0);
}

}  // namespace
}  // namespace mdk
