#include "preprocess/boxes/fuzzy_boxes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/math/affine3.h"
#include "common/motion/model.h"
#include "common/motion/posed_mesh.h"
#include "preprocess/pipeline.h"
#include "tests/preprocess/moving_meshes.h"
#include "tests/preprocess/whole_sequence.h"

namespace mdk {
namespace {

DecomposeResult decomposed(PoseSequence sequence, std::uint32_t clusters) {
  DecomposeOptions options;
  options.clusters = clusters;
  options.segments = 1;
  SilentProgress progress;
  return decompose(std::move(sequence), options, progress);
}

/// A random moment inside a clip, keys and the ends of intervals included.
KeyInterval random_moment(const ModelStorage& model, std::mt19937& random) {
  std::uniform_int_distribution<std::size_t> any_clip(0, model.clips.size() - 1);
  const Clip& clip = model.clips[any_clip(random)];
  std::uniform_int_distribution<std::uint32_t> any_key(0, clip.key_count - 1);
  const std::uint32_t key = clip.first_key + any_key(random);
  if (key + 1 == clip.first_key + clip.key_count) return at_key(key);
  std::uniform_real_distribution<float> any_s(0, 1);
  const float choices[] = {any_s(random), any_s(random), 0.5f, 0x1.fffffep-1f, 0x1p-24f, 0.0f};
  std::uniform_int_distribution<std::size_t> any_choice(0, std::size(choices) - 1);
  return {key, key + 1, choices[any_choice(random)]};
}

/// How many corners lie outside `boxes` (in triangle order) at `samples` random moments, computed
/// the way tracing computes them: vertices in float, maps by interpolate().
std::size_t escapes(const ModelStorage& storage, std::span<const Aabb> boxes, int samples,
                    std::mt19937& random) {
  const ModelView model = storage.view();
  PosedMesh mesh(model);
  std::size_t outside = 0;
  for (int i = 0; i < samples; ++i) {
    const KeyInterval at = random_moment(storage, random);
    mesh.set_time(at);
    for (std::size_t c = 0; c < model.clusters.size(); ++c) {
      const Affine3d map = at.key0 == at.key1 ? to_double(model.key_maps(at.key0)[c])
                                              : interpolate(model.key_maps(at.key0)[c],
                                                            model.key_maps(at.key1)[c], at.s);
      const Cluster& cluster = model.clusters[c];
      for (std::uint32_t t = cluster.first_triangle;
           t < cluster.first_triangle + cluster.triangle_count; ++t)
        for (const std::uint32_t v : model.triangles[t].v) {
          const Vec3d p = map.point(to_double(mesh.positions()[v]));
          const Aabbd box{to_double(boxes[t].lo), to_double(boxes[t].hi)};
          outside += !box.contains(p);
        }
    }
  }
  return outside;
}

/// One key's map of a cluster whose maps no fit would give: by its number a half turn of the one
/// before, a mirror image, nearly flat, a quarter turn, unrelated, the same again, far and small.
Affine3f adversarial_map(const Affine3f& before, std::uint32_t number, std::mt19937& random) {
  const auto turned = [&](double angle) {
    return rigid_motion(random_point(random, 1), angle, random_point(random, 0.3)) *
           to_double(before);
  };
  const auto scaled = [&](const Vec3d& scale) {
    Affine3d a = to_double(before);
    for (int i = 0; i < 3; ++i)
      for (double& m : a.m[i]) m *= scale[static_cast<std::size_t>(i)];
    return a;
  };
  switch (number % 8) {
    case 0:
      return to_float(turned(std::acos(-1.0)));
    case 1:
      return to_float(scaled({-1, 1, 1}));
    case 2:
      return to_float(scaled({1, 1e-4, 1}));
    case 3:
      return to_float(scaled({1, 1e4, 1}));
    case 4:
      return to_float(turned(std::acos(-1.0) / 2));
    case 5:
      return to_float(random_affine(random));
    case 6:
      return before;
    default:
      return to_float(turned(3.0) * rigid_motion({0, 0, 1}, 0.1, random_point(random, 50)));
  }
}

struct BoxedModel {
  ModelStorage model;
  std::vector<Aabb> boxes;
};

/// Random vertices at 40 keys, in one cluster with adversarial maps.
BoxedModel adversarial_model(std::uint32_t seed) {
  std::mt19937 random(seed);
  BoxedModel result;
  ModelStorage& model = result.model;
  const Mesh mesh = curved_sheet(3);
  const PoseSequence sequence = make_sequence(
      mesh, 40, [&](std::uint32_t, std::uint32_t) { return random_point(random, 2); });
  model.vertex_count = sequence.vertex_count;
  model.triangles = sequence.triangles;
  model.clips = sequence.clips;
  model.key_times = sequence.key_times;
  model.poses.key_positions = sequence.positions;
  model.clusters.resize(1);
  model.clusters[0].triangle_count = static_cast<std::uint32_t>(model.triangles.size());
  std::uniform_int_distribution<std::uint32_t> any_number(0, 7);
  model.local_from_world.push_back(to_float(random_affine(random)));
  while (model.local_from_world.size() < sequence.key_count())
    model.local_from_world.push_back(
        adversarial_map(model.local_from_world.back(), any_number(random), random));
  model.segments = {{0, sequence.key_count() - 1}};
  result.boxes = fuzzy_boxes(sequence, whole_members(sequence), model.local_from_world,
                             model.segments[0], BetweenKeys::kBound);
  return result;
}

TEST(FuzzyBoxes, HoldTheirTrianglesAtEveryTimeHoweverWildTheMotion) {
  for (std::uint32_t seed = 50; seed < 58; ++seed) {
    std::mt19937 random(seed);
    const ModelStorage model = decomposed(wild_motion(seed, 4 + seed % 5 * 3), 1 + seed % 4).model;
    EXPECT_EQ(escapes(model, first_fuzzy_boxes(model), 2000, random), 0u) << "seed " << seed;
    EXPECT_GT(escapes(model, boxes_over_keys_only(model), 50, random), 0u)
        << "seed " << seed << " is too tame: boxes over keys alone hold, too";
  }
}

TEST(FuzzyBoxes, HoldWhateverTheMapsDoBetweenKeys) {
  for (std::uint32_t seed = 80; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const BoxedModel boxed = adversarial_model(seed);
    EXPECT_EQ(escapes(boxed.model, boxed.boxes, 3000, random), 0u) << "seed " << seed;
  }
}

TEST(FuzzyBoxes, AreAsSmallAsTheTrianglesOfRigidParts) {
  // Parts that turn by up to 60 degrees between keys: their vertices take the chords, and yet stand
  // still in their clusters' bases.
  std::mt19937 random(101);
  const Mesh mesh = curved_sheet(6);
  std::vector<Affine3d> world_from_local(1);
  for (int key = 1; key < 12; ++key)
    world_from_local.push_back(
        rigid_motion(random_point(random, 1), 1.0, random_point(random, 0.5)) *
        world_from_local.back());
  const PoseSequence sequence =
      make_sequence(mesh, 12, [&](std::uint32_t key, std::uint32_t vertex) {
        return world_from_local[key].point(mesh.vertices[vertex]);
      });
  std::vector<Affine3f> maps;
  for (const Affine3d& a : world_from_local) maps.push_back(to_float(inverse(a)));
  const std::vector<Aabb> boxes =
      fuzzy_boxes(sequence, whole_members(sequence), maps, {0, 11}, BetweenKeys::kBound);
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    Aabbd rest;
    for (const std::uint32_t v : mesh.triangles[t].v) rest.extend(mesh.vertices[v]);
    EXPECT_LT(diagonal(boxes[t]), diagonal(rest) + 2e-5);
  }
}

TEST(FuzzyBoxes, HoldAgainstTheRoundingOfFloatVerticesFarFromTheOrigin) {
  // Positions near 1e6 in steps of 1/16: rounding moves vertices by more than the residual motion.
  std::mt19937 random(60);
  PoseSequence sequence = independent_parts(2, 9);
  for (Vec3f& v : sequence.positions) v = v + Vec3f{1e6f, -2e6f, 3e5f};
  const ModelStorage model = decomposed(std::move(sequence), 2).model;
  EXPECT_EQ(escapes(model, first_fuzzy_boxes(model), 2000, random), 0u);
}

TEST(FuzzyBoxes, HoldForTinyModels) {
  std::mt19937 random(61);
  PoseSequence sequence = wild_motion(61, 8);
  for (Vec3f& v : sequence.positions) v = v * 1e-6f;
  const ModelStorage model = decomposed(std::move(sequence), 3).model;
  EXPECT_EQ(escapes(model, first_fuzzy_boxes(model), 2000, random), 0u);
}

TEST(FuzzyBoxes, LieInTheirClustersLocalBox) {
  const ModelStorage model = decomposed(wild_motion(62, 8), 4).model;
  const std::vector<Aabb> boxes = first_fuzzy_boxes(model);
  for (std::size_t i = 0; i < model.clusters.size(); ++i) {
    const Cluster& c = model.clusters[i];
    for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t)
      EXPECT_TRUE(model.fuzzy_trees[i].local_box.contains(boxes[t]));
  }
}

TEST(FuzzyBoxes, AreNotMuchLargerThanTheCurvesInThem) {
  // The boxes must be conservative, not lazy: samples of the curves come close to every side.
  const ModelStorage storage = decomposed(wild_motion(63, 5), 2).model;
  const ModelView model = storage.view();
  PosedMesh mesh(model);
  std::vector<Aabbd> seen(model.triangle_count());
  for (const Clip& clip : model.clips)
    for (std::uint32_t key = clip.first_key; key + 1 < clip.first_key + clip.key_count; ++key)
      for (int step = 0; step <= 256; ++step) {
        const KeyInterval at{key, key + 1, static_cast<float>(step) / 256.0f};
        mesh.set_time(at);
        for (std::size_t c = 0; c < model.clusters.size(); ++c) {
          const Affine3d map =
              interpolate(model.key_maps(key)[c], model.key_maps(key + 1)[c], at.s);
          const Cluster& cluster = model.clusters[c];
          for (std::uint32_t t = cluster.first_triangle;
               t < cluster.first_triangle + cluster.triangle_count; ++t)
            for (const std::uint32_t v : model.triangles[t].v)
              seen[t].extend(map.point(to_double(mesh.positions()[v])));
        }
      }
  const std::vector<Aabb> boxes = first_fuzzy_boxes(storage);
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
    const double slack = 0.35 * diagonal(seen[t]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(boxes[t].lo[axis], seen[t].lo[axis], slack);
      EXPECT_NEAR(boxes[t].hi[axis], seen[t].hi[axis], slack);
    }
  }
}

TEST(ClusterWorldBoxes, HoldTheirVerticesAtEveryTime) {
  for (std::uint32_t seed = 70; seed < 74; ++seed) {
    std::mt19937 random(seed);
    PoseSequence sequence = wild_motion(seed, 10);
    if (seed % 2 == 1)
      for (Vec3f& v : sequence.positions) v = v + Vec3f{7e5f, 0.0f, -4e6f};
    const ModelStorage storage = decomposed(std::move(sequence), 3).model;
    const ModelView model = storage.view();
    PosedMesh mesh(model);
    std::size_t outside = 0;
    for (int i = 0; i < 2000; ++i) {
      const KeyInterval at = random_moment(storage, random);
      mesh.set_time(at);
      for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
        const Aabb box = cluster_world_box(model, c, at);
        const Cluster& cluster = model.clusters[c];
        for (std::uint32_t t = cluster.first_triangle;
             t < cluster.first_triangle + cluster.triangle_count; ++t)
          for (const std::uint32_t v : model.triangles[t].v)
            outside +=
                !box.contains(mesh.positions()[v]) || !model.bounds.contains(mesh.positions()[v]);
      }
    }
    EXPECT_EQ(outside, 0u) << "seed " << seed;
  }
}

}  // namespace
}  // namespace mdk
