#include "preprocess/fuzzy_boxes.h"

#include <gtest/gtest.h>

#include <random>

#include "common/motion/model.h"
#include "common/motion/posed_mesh.h"
#include "preprocess/pipeline.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

DecomposeResult decomposed(PoseSequence sequence, std::uint32_t clusters) {
  DecomposeOptions options;
  options.clusters = clusters;
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
  const Model model = storage.view();
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

/// Boxes of the same model over its keys only.
std::vector<Aabb> boxes_over_keys_only(const ModelStorage& model) {
  PoseSequence sequence;
  sequence.vertex_count = model.vertex_count;
  sequence.triangles = model.triangles;
  sequence.clips = model.clips;
  sequence.key_times = model.key_times;
  sequence.positions = model.key_positions;
  std::vector<std::uint32_t> cluster_of_triangle;
  for (std::uint32_t c = 0; c < model.clusters.size(); ++c)
    cluster_of_triangle.resize(cluster_of_triangle.size() + model.clusters[c].triangle_count, c);
  const ClusterMembers members =
      make_cluster_members(sequence.triangles, cluster_of_triangle,
                           static_cast<std::uint32_t>(model.clusters.size()), model.vertex_count);
  return fuzzy_boxes(sequence, members, model.local_from_world, BetweenKeys::kIgnore);
}

TEST(FuzzyBoxes, HoldTheirTrianglesAtEveryTimeHoweverWildTheMotion) {
  for (std::uint32_t seed = 50; seed < 58; ++seed) {
    std::mt19937 random(seed);
    const ModelStorage model = decomposed(wild_motion(seed, 4 + seed % 5 * 3), 1 + seed % 4).model;
    EXPECT_EQ(escapes(model, model.fuzzy_boxes, 2000, random), 0u) << "seed " << seed;
    EXPECT_GT(escapes(model, boxes_over_keys_only(model), 50, random), 0u)
        << "seed " << seed << " is too tame: boxes over keys alone hold, too";
  }
}

TEST(FuzzyBoxes, HoldAgainstTheRoundingOfFloatVerticesFarFromTheOrigin) {
  // Positions near 1e6 in steps of 1/16: rounding moves vertices by more than the residual motion.
  std::mt19937 random(60);
  PoseSequence sequence = independent_parts(2, 9);
  for (Vec3f& v : sequence.positions) v = v + Vec3f{1e6f, -2e6f, 3e5f};
  const ModelStorage model = decomposed(std::move(sequence), 2).model;
  EXPECT_EQ(escapes(model, model.fuzzy_boxes, 2000, random), 0u);
}

TEST(FuzzyBoxes, HoldForTinyModels) {
  std::mt19937 random(61);
  PoseSequence sequence = wild_motion(61, 8);
  for (Vec3f& v : sequence.positions) v = v * 1e-6f;
  const ModelStorage model = decomposed(std::move(sequence), 3).model;
  EXPECT_EQ(escapes(model, model.fuzzy_boxes, 2000, random), 0u);
}

TEST(FuzzyBoxes, LieInTheirClustersLocalBox) {
  const ModelStorage model = decomposed(wild_motion(62, 8), 4).model;
  for (const Cluster& c : model.clusters)
    for (std::uint32_t t = c.first_triangle; t < c.first_triangle + c.triangle_count; ++t)
      EXPECT_TRUE(c.local_box.contains(model.fuzzy_boxes[t]));
}

TEST(FuzzyBoxes, AreNotMuchLargerThanTheCurvesInThem) {
  // The boxes must be conservative, not lazy: samples of the curves come close to every side.
  const ModelStorage storage = decomposed(wild_motion(63, 5), 2).model;
  const Model model = storage.view();
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
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
    const double slack = 0.01 * seen[t].diagonal();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(model.fuzzy_boxes[t].lo[axis], seen[t].lo[axis], slack);
      EXPECT_NEAR(model.fuzzy_boxes[t].hi[axis], seen[t].hi[axis], slack);
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
    const Model model = storage.view();
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
