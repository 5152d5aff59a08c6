// --decompose bones: clusters from a rig, and pose spaces that hold for poses no clip contains.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/motion/posed_mesh.h"
#include "common/trace/renderer.h"
#include "preprocess/boxes/cost.h"
#include "preprocess/cluster/clusters.h"
#include "preprocess/maps/key_maps.h"
#include "preprocess/pipeline.h"
#include "tests/preprocess/moving_meshes.h"
#include "tests/preprocess/random_skeleton.h"
#include "tests/preprocess/whole_sequence.h"

namespace mdk {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

DecomposeOptions bones(PoseSampling sampling = PoseSampling::kCycle, double degrees = 90) {
  DecomposeOptions options;
  options.mode = DecomposeMode::kBones;
  options.sampling = sampling;
  options.joint_limit_degrees = degrees;
  return options;
}

DecomposeResult baked(PoseSequence sequence, const DecomposeOptions& options) {
  SilentProgress silent;
  return decompose(std::move(sequence), options, silent);
}

/// Corners outside the fuzzy boxes that hold for the mesh's current pose.
std::size_t escapes(const PosedMesh& mesh) {
  const ModelView& model = mesh.model();
  const std::uint32_t segment = mesh.is_live() ? 0 : segment_of(model, mesh.at());
  std::size_t outside = 0;
  for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
    const Affine3d map = mesh.cluster_map(c);
    const Aabb world = mesh.cluster_box(c);
    const Cluster& cluster = model.clusters[c];
    for (std::uint32_t t = cluster.first_triangle;
         t < cluster.first_triangle + cluster.triangle_count; ++t) {
      const Aabb box = model.fuzzy_box(segment, c, t);
      for (const std::uint32_t v : model.triangles[t].v) {
        const Vec3f& p = mesh.positions()[v];
        outside += !world.contains(p);
        outside += !Aabbd{to_double(box.lo), to_double(box.hi)}.contains(map.point(to_double(p)));
      }
    }
  }
  return outside;
}

/// Rigid parts that are a bone each.
PoseSequence rigid_parts(std::uint32_t parts, std::uint32_t keys,
                         std::vector<std::uint32_t>& part_of_triangle) {
  PoseSequence sequence = independent_parts(parts, keys, &part_of_triangle);
  Rig rig;
  rig.first_weight = {0};
  const std::uint32_t per_part = sequence.vertex_count / parts;
  for (std::uint32_t v = 0; v < sequence.vertex_count; ++v) {
    rig.base_positions.push_back(sequence.pose(0)[v]);
    rig.bone_weights.push_back({v / per_part, 1.0f});
    rig.first_weight.push_back(v + 1);
  }
  for (std::uint32_t key = 0; key < keys; ++key)
    for (std::uint32_t part = 0; part < parts; ++part)
      rig.bone_maps.push_back(
          to_float(rigid_motion({1, part + 1.0, 0}, 0.3 * key, {0.5 * part * key, 0, 0})));
  sequence.rig = std::move(rig);
  decode_positions(sequence);
  return sequence;
}

TEST(BoneClusters, RigidPartsAreAClusterEachWithBoxesAsSmallAsTheTriangles) {
  std::vector<std::uint32_t> part_of_triangle;
  const PoseSequence sequence = rigid_parts(4, 12, part_of_triangle);
  const DecomposeResult result = baked(sequence, bones());
  ASSERT_EQ(result.model.clusters.size(), 4u);
  EXPECT_EQ(result.stats.stop_reason, "bones");
  EXPECT_LT(result.stats.residual_max, 1e-5);
  for (std::uint32_t c = 0; c < 4; ++c)
    for (std::uint32_t i = 0; i < result.model.clusters[c].triangle_count; ++i)
      EXPECT_EQ(
          part_of_triangle[result.model
                               .source_triangles[result.model.clusters[c].first_triangle + i]],
          c);
}

TEST(BoneClusters, BoxesHoldAtEveryTimeOfTheClips) {
  const SkinnedMesh mesh = random_skinned_mesh(321, 9, 60 * kDegree);
  const DecomposeResult result = baked(mesh.sequence, bones());
  const ModelView model = result.model.view();
  EXPECT_TRUE(model.skeleton.joints.empty()) << "a cycle needs none";
  PosedMesh posed(model);
  std::mt19937 random(321);
  std::uniform_real_distribution<float> any_s(0, 1);
  std::size_t outside = 0;
  for (int i = 0; i < 500; ++i)
    for (std::uint32_t key = 0; key + 1 < model.key_count(); ++key) {
      posed.set_time({key, key + 1, any_s(random)});
      outside += escapes(posed);
    }
  EXPECT_EQ(outside, 0u);
}

TEST(BoneClusters, ATriangleGoesToTheBoneWithTheSmallestBoxOfAllBones) {
  const SkinnedMesh mesh = random_skinned_mesh(322, 6, 60 * kDegree);
  const PoseSequence& s = mesh.sequence;
  const std::vector<std::uint32_t> keys = all_keys(s);
  const BoneClusters clusters = assign_to_bones(s, whole_table(s), nullptr);
  const std::size_t bone_count = s.rig->bone_maps.size() / s.key_count();
  std::vector<double> model_areas;
  for (const std::uint32_t key : keys) model_areas.push_back(surface_area(pose_box(s.pose(key))));
  std::vector<std::vector<Affine3d>> maps;
  for (std::uint32_t bone = 0; bone < bone_count; ++bone)
    maps.push_back(base_from_world(*s.rig, bone, keys, s.key_count()));
  for (std::uint32_t t = 0; t < s.triangles.size(); ++t) {
    double least = INFINITY, own = INFINITY;
    for (std::uint32_t bone = 0; bone < bone_count; ++bone) {
      Aabbd box;
      for (const std::uint32_t key : keys)
        for (const std::uint32_t corner : s.triangles[t].v)
          box.extend(maps[bone][key].point(to_double(s.pose(key)[corner])));
      const double area = mean_area_weights(maps[bone], model_areas).area(box.extent());
      least = std::min(least, area);
      if (bone == clusters.bones[clusters.cluster_of_triangle[t]]) own = area;
    }
    EXPECT_LE(own, least * (1 + 1e-4)) << t;
  }
}

TEST(BoneClusters, ABoneThatIsFlatForAWhileGivesAUsableModel) {
  std::vector<std::uint32_t> part_of_triangle;
  PoseSequence sequence = rigid_parts(3, 8, part_of_triangle);
  for (const std::size_t key : {0u, 3u, 7u})
    for (float& entry : sequence.rig->bone_maps[key * 3 + 1].m[2]) entry = 0;
  for (Affine3f* bone = &sequence.rig->bone_maps[2]; bone < &*sequence.rig->bone_maps.end();
       bone += 3)
    for (auto& row : bone->m) row[0] = row[1] = row[2] = 0;
  decode_positions(sequence);
  const DecomposeResult result = baked(sequence, bones());
  const ModelView model = result.model.view();
  PosedMesh posed(model);
  for (std::uint32_t key = 0; key + 1 < model.key_count(); ++key)
    for (const float s : {0.0f, 0.3f, 0.9f}) {
      posed.set_time({key, key + 1, s});
      EXPECT_EQ(escapes(posed), 0u) << key << " " << s;
    }
}

TEST(PoseSpaceModel, HoldsInThousandsOfPosesThatNoClipContains) {
  for (const double degrees : {20.0, 90.0}) {
    const auto seed = static_cast<std::uint32_t>(330 + degrees);
    std::printf("seed %u\n", seed);
    const SkinnedMesh mesh = random_skinned_mesh(seed, 5, degrees * kDegree);
    const DecomposeResult result = baked(mesh.sequence, bones(PoseSampling::kPoseSpace, degrees));
    const ModelView model = result.model.view();
    ASSERT_EQ(model.skeleton.joints.size(), mesh.skeleton.joints.size());
    ASSERT_EQ(model.segment_count(), 1u);
    PosedMesh posed(model);
    std::mt19937 random(seed);
    std::size_t outside = 0;
    for (int i = 0; i < 4000; ++i) {
      const SkeletonPose pose = random_pose(mesh, 1, random);
      ASSERT_EQ(joint_past_limit(model.skeleton, pose), kNoParent);
      posed.set_pose(pose);
      outside += escapes(posed);
    }
    std::uniform_real_distribution<float> any_s(0, 1);
    for (int i = 0; i < 200; ++i)
      for (std::uint32_t key = 0; key + 1 < model.key_count(); ++key) {
        posed.set_time({key, key + 1, any_s(random)});
        outside += escapes(posed);
      }
    EXPECT_EQ(outside, 0u);
  }
}

TEST(PoseSpaceModel, EveryTechniqueThatPosesByHandGivesBruteForcesHits) {
  const SkinnedMesh mesh = random_skinned_mesh(341, 4, 80 * kDegree);
  const DecomposeResult result = baked(mesh.sequence, bones(PoseSampling::kPoseSpace, 80));
  const ModelView model = result.model.view();
  Renderer oracle(model, "brute-force"), renderer(model, "brute-force");
  std::mt19937 random(341);
  std::uint64_t hits = 0;
  for (int i = 0; i < 60; ++i) {
    const SkeletonPose pose = random_pose(mesh, 1, random);
    FrameRequest request{
        .at = at_key(0), .camera = fit_camera(model.bounds, 1), .width = 64, .height = 64};
    request.pose = &pose;
    hits += oracle.trace(request).hits;
    for (const TechniqueInfo& technique : technique_table()) {
      if (technique.kind == TechniqueKind::kPeer) continue;
      renderer.set_technique(technique.id);
      renderer.trace(request);
      EXPECT_EQ(count_mismatches(oracle.hits(), renderer.hits()), 0u) << technique.id;
    }
  }
  EXPECT_GT(hits, 1000u);
}

TEST(PoseSpaceModel, WiderLimitsMakeMoreExpensiveBoxes) {
  const SkinnedMesh mesh = random_skinned_mesh(342, 4, 10 * kDegree);
  double before = 0;
  for (const double degrees : {0.0, 15.0, 45.0, 90.0}) {
    const double cost =
        baked(mesh.sequence, bones(PoseSampling::kPoseSpace, degrees)).stats.sah_cost;
    EXPECT_GT(cost, before) << degrees;
    before = cost;
  }
}

TEST(PoseSpaceModel, TellsPosesPastTheLimitAndPosesOfOtherSkeletons) {
  const SkinnedMesh mesh = random_skinned_mesh(343, 3, 30 * kDegree);
  const DecomposeResult result = baked(mesh.sequence, bones(PoseSampling::kPoseSpace, 30));
  const ModelView model = result.model.view();
  SkeletonPose pose{std::vector<Vec3d>(model.skeleton.joints.size()), {0, 0}};
  pose.turns[4] = {0, 29 * kDegree, 0};
  EXPECT_EQ(joint_past_limit(model.skeleton, pose), kNoParent);
  pose.turns[4] = {0, 31 * kDegree, 0};
  EXPECT_EQ(joint_past_limit(model.skeleton, pose), 4u);
  pose.turns[4] = {0, std::nan(""), 0};
  EXPECT_EQ(joint_past_limit(model.skeleton, pose), 4u);
  pose.turns.pop_back();
  PosedMesh posed(model);
  EXPECT_THROW(posed.set_pose(pose), Error);
}

TEST(PoseSpaceModel, IsTheSameOnAnyNumberOfThreads) {
  const SkinnedMesh mesh = random_skinned_mesh(344, 6, 50 * kDegree);
  std::vector<unsigned char> bytes[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    bytes[threads - 1] =
        model_bytes(baked(mesh.sequence, bones(PoseSampling::kPoseSpace, 50)).model);
  }
  EXPECT_EQ(bytes[0], bytes[1]);
}

TEST(BoneClusters, NeedsBonesAndAPoseSpaceNeedsASkeleton) {
  const auto code_of = [](PoseSequence sequence, const DecomposeOptions& options) {
    try {
      baked(std::move(sequence), options);
    } catch (const Error& e) {
      return e.code();
    }
    return ErrorCode::kInternal;
  };
  EXPECT_EQ(code_of(wild_motion(1, 4), bones()), ErrorCode::kBadInput);
  SkinnedMesh mesh = random_skinned_mesh(345, 3, 1);
  DecomposeOptions options = bones(PoseSampling::kPoseSpace);
  options.segments = 2;
  EXPECT_EQ(code_of(mesh.sequence, options), ErrorCode::kUsage);
  options = bones(PoseSampling::kPoseSpace, 181);
  EXPECT_EQ(code_of(mesh.sequence, options), ErrorCode::kUsage);
  options = bones(PoseSampling::kPoseSpace);
  options.mode = DecomposeMode::kMotion;
  EXPECT_EQ(code_of(mesh.sequence, options), ErrorCode::kUsage);
  mesh.sequence.skeleton.reset();
  EXPECT_EQ(code_of(mesh.sequence, bones(PoseSampling::kPoseSpace)), ErrorCode::kBadInput);
}

}  // namespace
}  // namespace mdk
