#include "preprocess/pose/pose_space.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "tests/preprocess/random_skeleton.h"

namespace mdk {
namespace {

/// One basis per bone, turned and shifted at random, and the box of every vertex in it.
struct Bounded {
  std::vector<Affine3f> bases;
  std::vector<std::vector<Aabbd>> boxes;  ///< per bone and vertex

  Bounded(const SkinnedMesh& mesh, std::mt19937& random) {
    const PoseSpace space(mesh.skeleton.view(), mesh.sequence.rig->view(),
                          mesh.sequence.key_count());
    std::uniform_real_distribution<double> any(-1, 1);
    for (std::uint32_t bone = 0; bone < mesh.skeleton.bones.size(); ++bone) {
      Affine3d basis = rotation({any(random), any(random), any(random)});
      for (auto& row : basis.m) row[3] = any(random);
      bases.push_back(to_float(basis));
      BoneSpace seen(space, bone);
      EXPECT_TRUE(seen.is_usable());
      boxes.emplace_back();
      for (std::uint32_t v = 0; v < mesh.sequence.vertex_count; ++v)
        boxes.back().push_back(seen.vertex_box(v, to_double(bases.back())));
    }
  }

  /// Vertices outside their boxes, over all bones, computed as the run time computes them.
  std::size_t escapes(const SkinnedMesh& mesh, const SkeletonPose& pose) const {
    const RigView rig = mesh.sequence.rig->view();
    const std::vector<Affine3f> maps = bone_maps(mesh.skeleton.view(), pose);
    std::vector<Vec3f> positions(mesh.sequence.vertex_count);
    pose_vertices(rig, {maps, pose.target_weights}, {0, mesh.sequence.vertex_count}, positions);
    std::size_t outside = 0;
    for (std::size_t bone = 0; bone < boxes.size(); ++bone) {
      const Affine3d local = to_double(bases[bone]) * inverse(to_double(maps[bone]));
      for (std::size_t v = 0; v < positions.size(); ++v)
        outside += !boxes[bone][v].contains(local.point(to_double(positions[v])));
    }
    return outside;
  }
};

TEST(PoseSpace, BoxesHoldEveryVertexSeenFromEveryBoneInEveryPoseWithinLimits) {
  for (const double degrees : {5.0, 30.0, 90.0, 140.0, 180.0}) {
    const auto seed = static_cast<std::uint32_t>(degrees);
    std::printf("seed %u\n", seed);
    std::mt19937 random(seed);
    const SkinnedMesh mesh = random_skinned_mesh(seed, 4, degrees * std::acos(-1.0) / 180);
    const Bounded bounded(mesh, random);
    std::size_t outside = 0;
    for (int i = 0; i < 3000; ++i) {
      const SkeletonPose pose = random_pose(mesh, 1, random);
      ASSERT_EQ(joint_past_limit(mesh.skeleton.view(), pose), kNoParent);
      outside += bounded.escapes(mesh, pose);
    }
    for (const SkeletonPose& pose : mesh.key_poses) outside += bounded.escapes(mesh, pose);
    EXPECT_EQ(outside, 0u) << degrees << " degrees";
  }
}

TEST(PoseSpace, PosesPastTheLimitLeaveTheBoxesAndAreTold) {
  std::mt19937 random(311);
  const SkinnedMesh mesh = random_skinned_mesh(311, 3, 0.3);
  const Bounded bounded(mesh, random);
  std::size_t outside = 0;
  for (int i = 0; i < 200; ++i) {
    const SkeletonPose pose = random_pose(mesh, 4, random);
    EXPECT_NE(joint_past_limit(mesh.skeleton.view(), pose), kNoParent);
    outside += bounded.escapes(mesh, pose);
  }
  EXPECT_GT(outside, 0u);
}

TEST(PoseSpace, WithoutAnyTurnABoxIsHardlyLargerThanTheVertex) {
  SkinnedMesh mesh = random_skinned_mesh(312, 1, 0);
  std::mt19937 random(312);
  const Bounded bounded(mesh, random);
  for (const std::vector<Aabbd>& boxes : bounded.boxes)
    for (const Aabbd& box : boxes) EXPECT_LT(diagonal(box), 1e-3);
}

TEST(PoseSpace, ABoxAroundOneJointIsItsCapsOwn) {
  // Two joints; a vertex of the second, one away from it along x, seen from the first.
  SkinnedMesh mesh;
  Skeleton& skeleton = mesh.skeleton;
  skeleton.joints.resize(2);
  skeleton.joints[1].parent = 0;
  skeleton.joints[1].limit = 0.5f;
  skeleton.bones.resize(2);
  skeleton.bones[1].joint = 1;
  Rig rig;
  rig.base_positions = {{1, 0, 0}};
  rig.first_weight = {0, 1};
  rig.bone_weights = {{1, 1.0f}};
  rig.bone_maps.resize(2);
  const PoseSpace space(skeleton.view(), rig.view(), 1);
  const Aabbd box = BoneSpace(space, 0).vertex_box(0, {});
  EXPECT_NEAR(box.lo.x, std::cos(0.5), 1e-4);
  EXPECT_NEAR(box.hi.x, 1, 1e-4);
  EXPECT_NEAR(box.lo.y, -std::sin(0.5), 1e-4);
  EXPECT_NEAR(box.hi.z, std::sin(0.5), 1e-4);
}

}  // namespace
}  // namespace mdk
