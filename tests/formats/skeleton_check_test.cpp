// Every way in which a stored skeleton can be beyond posing is found and named.
#include "formats/skeleton_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/motion/posed_mesh.h"
#include "formats/mdk_view.h"
#include "formats/mdk_writer.h"
#include "formats/model_check.h"
#include "tests/formats/fault.h"
#include "tests/formats/sample_model.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<Fault> faults() {
  using M = ModelStorage&;
  return {
      {"names_without_joints", "joint_names: 7 of them, not 0",
       [](M m) { m.skeleton.joints.clear(); }},
      {"bones_without_joints", "bone_bindings: 3 of them, not 0",
       [](M m) {
         m.skeleton.joints.clear();
         m.skeleton.names.clear();
       }},
      {"clusters_without_joints", "cluster_bones: 2 of them, not 0", [](M m) { m.skeleton = {}; }},
      {"bindings_cut", "bone_bindings: 2 of them, not 3", [](M m) { m.skeleton.bones.pop_back(); }},
      {"cluster_bones_long", "cluster_bones: 3 of them, not 2",
       [](M m) { m.cluster_bones.push_back({}); }},
      {"parent_after", "joints: joint 1 does not stand",
       [](M m) { m.skeleton.joints[1].parent = 1; }},
      {"limit_nan", "joints: joint 0 has a limit", [](M m) { m.skeleton.joints[0].limit = kNan; }},
      {"limit_negative", "joints: joint 1 has a limit",
       [](M m) { m.skeleton.joints[1].limit = -0.1f; }},
      {"limit_wide", "joints: joint 1 has a limit", [](M m) { m.skeleton.joints[1].limit = 3.2f; }},
      {"name_gap", "joints: joint 1 has no name",
       [](M m) { m.skeleton.joints[1].name_offset = 4; }},
      {"name_long", "joints: joint 1 has no name",
       [](M m) { m.skeleton.joints[1].name_bytes = ~0u; }},
      {"names_left", "joint_names: some", [](M m) { m.skeleton.names.push_back('x'); }},
      {"rest_nan", "joints: joint 1 has a rest",
       [](M m) { m.skeleton.joints[1].parent_from_joint.m[2][3] = kNan; }},
      {"scale_nan", "joints: joint 0 has a rest", [](M m) { m.skeleton.joints[0].scale.y = kNan; }},
      {"binding_past_end", "bone_bindings: bone 2 hangs",
       [](M m) { m.skeleton.bones[2].joint = 2; }},
      {"binding_nan", "bone_bindings: bone 0 has",
       [](M m) { m.skeleton.bones[0].joint_from_base.m[0][0] = kNan; }},
      {"cluster_past_end", "cluster_bones: cluster 1 follows",
       [](M m) { m.cluster_bones[1].bone = 3; }},
      {"cluster_nan", "cluster_bones: cluster 0 has",
       [](M m) { m.cluster_bones[0].local_from_base.m[0][0] = kNan; }},
  };
}

class EverySkeletonFault : public testing::TestWithParam<Fault> {};

TEST_P(EverySkeletonFault, IsFoundAndNamed) {
  ModelStorage model = sample_skeleton_model();
  ASSERT_EQ(find_inconsistency(model.view()), "");
  GetParam().make(model);
  EXPECT_THAT(check_skeleton(model.view()), testing::StartsWith(GetParam().sentence));
}

INSTANTIATE_TEST_SUITE_P(Skeletons, EverySkeletonFault, testing::ValuesIn(faults()), fault_name);

TEST(SkeletonCheck, ASkeletonNeedsARigAndOneSegment) {
  ModelStorage model = sample_skeleton_model();
  model.segments = sample_model().segments;
  EXPECT_THAT(check_skeleton(model.view()), testing::StartsWith("segments: more than one"));
  model = sample_skeleton_model();
  model.poses.kind = PoseKind::kKeyPositions;
  EXPECT_THAT(check_skeleton(model.view()), testing::StartsWith("joints: there"));
}

TEST(SkeletonFile, ASkeletonIsReadAsItWasWrittenAndCanBePosed) {
  const TempFolder folder;
  const std::string path = folder.file("posable.mdk");
  const ModelStorage written = sample_skeleton_model();
  write_mdk(written.view(), path);
  const MdkFile file(path);
  const SkeletonView& skeleton = file.model().skeleton;
  ASSERT_EQ(skeleton.joints.size(), 2u);
  EXPECT_EQ(skeleton.name(skeleton.joints[0]), "hip");
  EXPECT_EQ(skeleton.name(skeleton.joints[1]), "tail");
  EXPECT_EQ(skeleton.joints[1].parent_from_joint, written.skeleton.joints[1].parent_from_joint);
  EXPECT_EQ(skeleton.bones[2].joint, 1u);
  PosedMesh mesh(file.model());
  // Bone 1 stands one up, twice as large, and turns from x to y: strip 1 hangs on it.
  mesh.set_pose({{{}, {0, 0, 1.5}}, {0}});
  const Vec3f base = written.poses.rig.base_positions[7];
  const Vec3f p = mesh.positions()[7];
  EXPECT_NEAR(p.x, 2 * (base.x * std::cos(1.5) - base.y * std::sin(1.5)), 1e-5);
  EXPECT_NEAR(p.y, 1 + 2 * (base.x * std::sin(1.5) + base.y * std::cos(1.5)), 1e-5);
}

}  // namespace
}  // namespace mdk::test
