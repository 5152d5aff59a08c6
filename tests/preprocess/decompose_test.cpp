#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/trace/renderer.h"
#include "preprocess/pipeline.h"
#include "tests/preprocess/moving_meshes.h"
#include "tests/preprocess/whole_sequence.h"

namespace mdk {
namespace {

DecomposeResult run(const PoseSequence& sequence, const DecomposeOptions& options = {}) {
  SilentProgress progress;
  return decompose(sequence, options, progress);
}

bool finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Everything a model promises, whatever it was made from.
void expect_sound(const ModelStorage& m, const PoseSequence& source) {
  const std::size_t triangles = source.triangles.size(), clusters = m.clusters.size();
  ASSERT_GE(clusters, 1u);
  ASSERT_EQ(m.triangles.size(), triangles);
  const std::size_t segments = m.segments.size();
  ASSERT_GE(segments, 1u);
  ASSERT_EQ(m.fuzzy_boxes.size(), segments * triangles);
  ASSERT_EQ(m.fuzzy_trees.size(), segments * clusters);
  ASSERT_EQ(m.source_triangles.size(), triangles);
  ASSERT_EQ(m.local_from_world.size(), clusters * source.key_count());
  ASSERT_EQ(m.key_boxes.size(), source.key_count());
  ASSERT_EQ(m.cluster_world_boxes.size(), clusters * source.key_count());
  std::vector<bool> seen(triangles, false);
  for (std::size_t t = 0; t < triangles; ++t) {
    ASSERT_LT(m.source_triangles[t], triangles);
    ASSERT_FALSE(seen[m.source_triangles[t]]);
    seen[m.source_triangles[t]] = true;
    for (int corner = 0; corner < 3; ++corner)
      EXPECT_EQ(m.poses.key_positions[m.triangles[t].v[corner]],
                source.positions[source.triangles[m.source_triangles[t]].v[corner]]);
  }
  std::uint32_t next = 0;
  for (std::size_t c = 0; c < clusters; ++c) {
    const Cluster& cluster = m.clusters[c];
    EXPECT_EQ(cluster.first_triangle, next);
    EXPECT_GT(cluster.triangle_count, 0u);
    next += cluster.triangle_count;
    for (std::uint32_t t = cluster.first_triangle + 1; t < next; ++t)
      EXPECT_LT(m.source_triangles[t - 1], m.source_triangles[t]);
    for (std::uint32_t s = 0; s < segments; ++s) {
      EXPECT_EQ(validate(m.view().tree_view(m.fuzzy_trees[s * clusters + c]),
                         cluster.first_triangle, next),
                "");
      for (const Aabb& box : m.view().cluster_fuzzy_boxes(s, c)) {
        EXPECT_FALSE(box.empty());
        EXPECT_TRUE(finite(box.lo) && finite(box.hi));
      }
    }
  }
  EXPECT_EQ(next, triangles);
  for (const Affine3f& map : m.local_from_world) {
    for (const auto& row : map.m)
      for (const float entry : row) ASSERT_TRUE(std::isfinite(entry));
    EXPECT_NE(to_double(map).determinant(), 0);
  }
  for (const Vec3f& v : m.poses.key_positions) EXPECT_TRUE(m.bounds.contains(v));
}

void expect_sound_stats(const DecomposeStats& s) {
  for (const double v : {s.residual_rms, s.residual_max, s.sah_cost}) {
    EXPECT_TRUE(std::isfinite(v));
    EXPECT_GE(v, 0);
  }
}

struct DegenerateCase {
  const char* name;
  std::function<PoseSequence()> make;
};

Mesh one_triangle() { return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{{0, 1, 2}}}}; }

PoseSequence moved_by(const Mesh& mesh, std::uint32_t keys,
                      std::function<Vec3d(const Vec3d&, std::uint32_t)> move) {
  return make_sequence(mesh, keys,
                       [&](std::uint32_t k, std::uint32_t i) { return move(mesh.vertices[i], k); });
}

Mesh loose_triangles(std::uint32_t count) {
  std::mt19937 random(80);
  Mesh mesh;
  for (std::uint32_t t = 0; t < count; ++t) {
    const Vec3d at = random_point(random, 10);
    for (int i = 0; i < 3; ++i) mesh.vertices.push_back(at + random_point(random, 0.1));
    mesh.triangles.push_back({{3 * t, 3 * t + 1, 3 * t + 2}});
  }
  return mesh;
}

const DegenerateCase kDegenerateCases[] = {
    {"OneTriangle",
     [] {
       return moved_by(one_triangle(), 5, [](const Vec3d& v, std::uint32_t k) {
         return rigid_motion({0, 0, 1}, k, {1.0 * k, 0, 0}).point(v);
       });
     }},
    {"ZeroAreaTriangles",
     [] {
       Mesh mesh = curved_sheet(3);
       for (Triangle& t : mesh.triangles) t.v[2] = t.v[0];
       return moved_by(mesh, 4, [](const Vec3d& v, std::uint32_t k) { return v * (1.0 + k); });
     }},
    {"AllVerticesOnePoint",
     [] {
       return moved_by(curved_sheet(3), 4, [](const Vec3d&, std::uint32_t k) {
         return Vec3d{1.0 * k, 2, 3};
       });
     }},
    {"FlatSheet",
     [] {
       return moved_by(curved_sheet(4), 6, [](const Vec3d& v, std::uint32_t k) {
         return rigid_motion({1, 0, 0}, 0.5 * k, {}).point({v.x, v.y, 0});
       });
     }},
    {"LineOfTriangles",
     [] {
       return moved_by(curved_sheet(4), 6, [](const Vec3d& v, std::uint32_t k) {
         return rigid_motion({1, 1, 0}, 0.5 * k, {}).point({v.x + v.y, 0, 0});
       });
     }},
    {"OneKey",
     [] { return moved_by(curved_sheet(4), 1, [](const Vec3d& v, std::uint32_t) { return v; }); }},
    {"TwoKeys", [] { return wild_motion(81, 2); }},
    {"DuplicatedKeys",
     [] {
       return moved_by(curved_sheet(4), 9, [](const Vec3d& v, std::uint32_t k) {
         return rigid_motion({1, 2, 3}, k / 3, {}).point(v);
       });
     }},
    {"StaticMesh",
     [] { return moved_by(curved_sheet(4), 7, [](const Vec3d& v, std::uint32_t) { return v; }); }},
    {"CollapsedPose",
     [] {
       return moved_by(curved_sheet(4), 8, [](const Vec3d& v, std::uint32_t k) {
         return v * (k == 3 ? 0.0 : k == 5 ? 1e-9 : 1.0) + Vec3d{0.1 * k, 0, 0};
       });
     }},
    {"CollapsedFirstPose",
     [] {
       return moved_by(curved_sheet(4), 8,
                       [](const Vec3d& v, std::uint32_t k) { return v * (k == 0 ? 0.0 : 1.0); });
     }},
    {"MirroredPose",
     [] {
       return moved_by(curved_sheet(4), 6, [](const Vec3d& v, std::uint32_t k) {
         return Vec3d{k % 2 == 0 ? v.x : -v.x, v.y, v.z};
       });
     }},
    {"FlyingApart",
     [] {
       const Mesh mesh = loose_triangles(60);
       return make_sequence(mesh, 10, [&](std::uint32_t k, std::uint32_t i) {
         const double p = i / 3;
         return mesh.vertices[i] + Vec3d{std::sin(p), std::cos(3 * p), p * 0.1} * (100.0 * k * k);
       });
     }},
    {"Huge",
     [] {
       PoseSequence s = wild_motion(82, 8);
       for (Vec3f& v : s.positions) v = v * 1e6f;
       return s;
     }},
    {"Tiny",
     [] {
       PoseSequence s = wild_motion(83, 8);
       for (Vec3f& v : s.positions) v = v * 1e-6f;
       return s;
     }},
    {"ThousandsOfLooseParts",
     [] {
       const Mesh mesh = loose_triangles(3000);
       return make_sequence(mesh, 6, [&](std::uint32_t k, std::uint32_t i) {
         const double p = i / 3;
         return rigid_motion({std::sin(p), 1, 0}, 0.2 * k * std::cos(p), {0, 0.1 * k, 0})
             .point(mesh.vertices[i]);
       });
     }},
};

class DegenerateInput : public testing::TestWithParam<DegenerateCase> {};

TEST_P(DegenerateInput, GivesASoundModelInEveryMode) {
  const PoseSequence sequence = GetParam().make();
  DecomposeOptions automatic, none, fixed, percent;
  none.mode = DecomposeMode::kNone;
  fixed.clusters =
      std::min<std::uint32_t>(4, static_cast<std::uint32_t>(sequence.triangles.size()));
  fixed.rest_key = sequence.key_count() - 1;
  percent.stop_percent = 5;
  for (const DecomposeOptions& options : {automatic, none, fixed, percent}) {
    const DecomposeResult result = run(sequence, options);
    expect_sound(result.model, sequence);
    expect_sound_stats(result.stats);
    if (options.clusters != 0) {
      EXPECT_EQ(result.model.clusters.size(), options.clusters);
      EXPECT_EQ(result.model.rest_key, *options.rest_key);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Decompose, DegenerateInput, testing::ValuesIn(kDegenerateCases),
                         [](const auto& tested) { return tested.param.name; });

TEST(Decompose, GivesTheSameBytesForOneAndForTwoThreads) {
  const PoseSequence sequence = wild_motion(84, 30);
  std::vector<unsigned char> bytes[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    bytes[threads - 1] = model_bytes(run(sequence).model);
  }
  EXPECT_EQ(bytes[0], bytes[1]);
}

TEST(Decompose, NoneIsOneClusterInTheWorldItself) {
  const PoseSequence sequence = independent_parts(3, 8);
  DecomposeOptions options;
  options.mode = DecomposeMode::kNone;
  const DecomposeResult result = run(sequence, options);
  ASSERT_EQ(result.model.clusters.size(), 1u);
  for (const Affine3f& map : result.model.local_from_world) EXPECT_EQ(map, Affine3f{});
  EXPECT_EQ(result.stats.stop_reason, "none");
  EXPECT_GT(result.stats.residual_rms, 0.01);
}

TEST(Decompose, NoneIsAClusterPerMeshOfTheSource) {
  PoseSequence sequence = independent_parts(3, 8);
  const std::size_t triangles = sequence.triangles.size();
  for (std::size_t t = 0; t < triangles; ++t)
    sequence.triangle_meshes.push_back(static_cast<std::uint32_t>(3 * t / triangles));
  DecomposeOptions options;
  options.mode = DecomposeMode::kNone;
  const DecomposeResult result = run(sequence, options);
  ASSERT_EQ(result.model.clusters.size(), 3u);
  expect_sound(result.model, sequence);
  for (const Affine3f& map : result.model.local_from_world) EXPECT_EQ(map, Affine3f{});
  for (std::uint32_t c = 0; c < 3; ++c) {
    const Cluster& cluster = result.model.clusters[c];
    for (std::uint32_t i = 0; i < cluster.triangle_count; ++i)
      EXPECT_EQ(sequence.triangle_meshes[result.model.source_triangles[cluster.first_triangle + i]],
                c);
  }
}

TEST(Decompose, MotionMakesTheCostOfMovingPartsAFractionOfNone) {
  const PoseSequence sequence = independent_parts(3, 20);
  DecomposeOptions none;
  none.mode = DecomposeMode::kNone;
  const DecomposeResult with = run(sequence), without = run(sequence, none);
  EXPECT_EQ(with.model.clusters.size(), 3u);
  EXPECT_LT(with.stats.sah_cost, 0.5 * without.stats.sah_cost);
  EXPECT_LT(with.stats.residual_rms, 1e-6);
}

TEST(Decompose, ExtremesThatOnlyFewKeysShowAreStillBoundedAndCounted) {
  // More keys than clustering looks at, one of them wild.
  const Mesh mesh = curved_sheet(5);
  const PoseSequence sequence = make_sequence(mesh, 300, [&](std::uint32_t k, std::uint32_t i) {
    Vec3d v = mesh.vertices[i];
    if (k == 217) v.z += 3 * v.x * v.y;
    return rigid_motion({0, 1, 0}, 0.05 * k, {}).point(v);
  });
  const DecomposeResult result = run(sequence);
  expect_sound(result.model, sequence);
  EXPECT_GT(result.stats.residual_max, 10 * result.stats.residual_rms);
}

TEST(Decompose, AppearanceFollowsItsTriangles) {
  PoseSequence sequence = independent_parts(3, 6);
  std::mt19937 random(85);
  std::shuffle(sequence.triangles.begin(), sequence.triangles.end(), random);
  sequence.appearance.materials.resize(sequence.triangles.size());
  for (std::uint32_t t = 0; t < sequence.triangles.size(); ++t) {
    sequence.appearance.triangle_materials[t] = t;
    for (std::uint32_t c = 0; c < 3; ++c) {
      sequence.appearance.corner_texcoords.push_back(
          {static_cast<float>(t), static_cast<float>(c)});
      sequence.appearance.corner_colors.push_back(3 * t + c);
    }
  }
  const ModelStorage model = run(sequence).model;
  for (std::uint32_t t = 0; t < model.triangles.size(); ++t) {
    const std::uint32_t source = model.source_triangles[t];
    EXPECT_EQ(model.appearance.triangle_materials[t], source);
    for (std::uint32_t c = 0; c < 3; ++c) {
      EXPECT_EQ(model.appearance.corner_texcoords[3 * t + c].u, static_cast<float>(source));
      EXPECT_EQ(model.appearance.corner_colors[3 * t + c], 3 * source + c);
    }
  }
}

TEST(Decompose, StepsStartWithOneClusterAndEndWithWhatThereIs) {
  const DecomposeResult result = run(independent_parts(6, 12));
  const std::vector<GrowthStep>& steps = result.stats.steps;
  ASSERT_GE(steps.size(), 3u);
  EXPECT_EQ(steps.front().clusters, 1u);
  EXPECT_EQ(steps.back().clusters, result.model.clusters.size());
  for (std::size_t i = 1; i < steps.size(); ++i) {
    EXPECT_GT(steps[i].clusters, steps[i - 1].clusters);
    EXPECT_LT(steps[i].sah_cost, steps[i - 1].sah_cost);
    EXPECT_LT(steps[i].fuzzy_area, steps[i - 1].fuzzy_area);
  }
  for (const GrowthStep& step : steps) EXPECT_LT(step.fuzzy_area, step.sah_cost);
  EXPECT_LT(steps.back().residual_rms, 0.01 * steps.front().residual_rms);
}

TEST(Decompose, RefinementMakesBoxesSmallerAndSaysByHowMuch) {
  for (const std::uint32_t seed : {87u, 88u, 89u}) {
    DecomposeOptions options;
    options.clusters = 4;
    options.segments = 1;
    SilentProgress progress;
    const DecomposeResult refined = decompose(wild_motion(seed, 12), options, progress);
    options.refine = false;
    const DecomposeResult plain = decompose(wild_motion(seed, 12), options, progress);
    EXPECT_EQ(plain.stats.refine_gain, 0);
    EXPECT_GT(refined.stats.refine_gain, 0) << "seed " << seed;
    EXPECT_LT(refined.stats.sah_cost, plain.stats.sah_cost) << "seed " << seed;
  }
}

TEST(Decompose, CostsLittleMoreThanThePapersMethodEvenWhereBoxesAtKeysMislead) {
  for (const std::uint32_t seed : {90u, 91u, 92u}) {
    DecomposeOptions options;
    options.segments = 1;
    SilentProgress progress;
    const DecomposeResult ours = decompose(wild_motion(seed, 24), options, progress);
    options.stop_percent = 1;
    options.refine = false;
    const DecomposeResult paper = decompose(wild_motion(seed, 24), options, progress);
    EXPECT_EQ(paper.stats.stop_reason, "percent");
    EXPECT_LT(ours.stats.sah_cost, 1.1 * paper.stats.sah_cost) << "seed " << seed;
  }
}

TEST(Decompose, MapsNeverMirrorThoughClustersAreFlat) {
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u})
    for (const std::uint32_t clusters : {6u, 24u, 50u}) {
      DecomposeOptions options;
      options.clusters = clusters;
      options.segments = 1;
      EXPECT_EQ(mirrored_maps(run(wild_motion(seed, 40), options).model), 0u)
          << clusters << " clusters, seed " << seed;
    }
}

DecomposeOptions at_keys_only(std::uint32_t clusters = 4) {
  DecomposeOptions options;
  options.clusters = clusters;
  options.between = BetweenKeys::kIgnore;
  return options;
}

TEST(Decompose, BoxesOfKeysOnlyAreThoseOfTheKeysAndTheModelSaysSo) {
  const PoseSequence sequence = wild_motion(93, 20);
  DecomposeOptions options = at_keys_only();
  options.segments = 1;
  const DecomposeResult keys_only = run(sequence, options);
  EXPECT_FALSE(keys_only.model.holds_between_keys);
  EXPECT_FALSE(keys_only.model.view().holds_between_keys);
  const std::vector<Aabb> boxes = first_fuzzy_boxes(keys_only.model);
  const std::vector<Aabb> expected = boxes_over_keys_only(keys_only.model);
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    EXPECT_TRUE(boxes[t].contains(expected[t].lo) && boxes[t].contains(expected[t].hi)) << t;
    const Vec3d slack =
        to_double(boxes[t].hi - boxes[t].lo) - to_double(expected[t].hi - expected[t].lo);
    EXPECT_LT(std::max({slack.x, slack.y, slack.z}), 1e-3) << "rounded to the grid, no more";
  }
  options.between = BetweenKeys::kBound;
  const DecomposeResult always = run(sequence, options);
  EXPECT_TRUE(always.model.holds_between_keys);
  EXPECT_LT(keys_only.stats.sah_cost, always.stats.sah_cost);
}

TEST(Decompose, AModelOfKeysOnlyIsTracedAtKeysAlone) {
  const DecomposeResult baked = run(wild_motion(94, 16), at_keys_only());
  const ModelView model = baked.model.view();
  Renderer oracle(model, "brute-force"), renderer(model, "brute-force");
  FrameRequest request{
      .at = at_key(0), .camera = fit_camera(model.bounds, 1), .width = 64, .height = 64};
  std::uint64_t hits = 0;
  for (std::uint32_t key = 0; key < model.key_count(); ++key) {
    request.at = at_key(key);
    hits += oracle.trace(request).hits;
    for (const TechniqueInfo& technique : technique_table()) {
      if (technique.kind == TechniqueKind::kPeer) continue;
      renderer.set_technique(technique.id);
      renderer.trace(request);
      EXPECT_EQ(count_mismatches(oracle.hits(), renderer.hits()), 0u) << technique.id;
    }
  }
  EXPECT_GT(hits, 300u);
  request.at = {2, 3, 0.5f};
  try {
    renderer.trace(request);
    ADD_FAILURE() << "a time between keys was traced";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kUsage);
  }
}

TEST(Decompose, RefusesWhatDoesNotExist) {
  const PoseSequence sequence = wild_motion(88, 5);
  const auto code_of = [](const PoseSequence& s, const DecomposeOptions& options) {
    try {
      run(s, options);
    } catch (const Error& e) {
      return e.code();
    }
    return ErrorCode::kInternal;
  };
  DecomposeOptions options;
  options.rest_key = 5;
  EXPECT_EQ(code_of(sequence, options), ErrorCode::kUsage);
  options = {};
  options.clusters = static_cast<std::uint32_t>(sequence.triangles.size()) + 1;
  EXPECT_EQ(code_of(sequence, options), ErrorCode::kUsage);
  options = {};
  options.stop_percent = -1;
  EXPECT_EQ(code_of(sequence, options), ErrorCode::kUsage);
  PoseSequence bare = sequence;
  bare.triangles.clear();
  bare.appearance.triangle_materials.clear();
  EXPECT_EQ(code_of(bare, {}), ErrorCode::kBadInput);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30f}) {
    PoseSequence broken = sequence;
    broken.positions[17].y = bad;
    EXPECT_EQ(code_of(broken, {}), ErrorCode::kBadInput);
  }
}

}  // namespace
}  // namespace mdk
