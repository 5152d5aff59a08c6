// Skins and morph targets: which joints move a vertex, and by how much.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/formats/gltf_builder.h"
#include "tests/formats/gltf_expect.h"

namespace mdk::test {
namespace {

/// The unit triangle on node 0 with a skin of two joints: node 1 shifts by (10, 0, 0), node 2 by
/// (0, 20, 0). Node 0 itself is shifted by (0, 0, 100), which a skin must ignore.
class Skinned {
 public:
  Skinned() {
    positions = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
    b.add("nodes", "{\"mesh\": 0, \"skin\": 0, \"translation\": [0, 0, 100]}");
    b.add("nodes", "{\"translation\": [10, 0, 0]}");
    b.add("nodes", "{\"translation\": [0, 20, 0]}");
  }

  std::string position() const { return "\"POSITION\": " + std::to_string(positions); }

  /// JOINTS_n and WEIGHTS_n as attributes.
  std::string set(int n, const std::vector<std::uint8_t>& joints,
                  const std::vector<float>& weights) {
    return influences(n, b.accessor<std::uint8_t>("VEC4", joints),
                      b.accessor<float>("VEC4", weights));
  }
  static std::string influences(int n, int joints, int weights) {
    return ", \"JOINTS_" + std::to_string(n) + "\": " + std::to_string(joints) + ", \"WEIGHTS_" +
           std::to_string(n) + "\": " + std::to_string(weights);
  }

  PoseSequence read(const std::string& attributes, const std::string& more = "",
                    const std::string& skin = "{\"joints\": [1, 2]}") {
    b.mesh(attributes, more);
    b.add("skins", skin);
    return read_built(b).sequence;
  }

  GltfBuilder b;
  int positions = 0;
};

TEST(GltfSkin, BlendsJointsByWeightAndIgnoresTheMeshNode) {
  Skinned m;
  expect_pose(m.read(m.position() + m.set(0, {0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0},
                                          {1, 0, 0, 0, 0.25f, 0.75f, 0, 0, 1, 0, 0, 0})),
              0, {{10, 0, 0}, {3.5f, 15, 0}, {0, 21, 0}});
}

TEST(GltfSkin, WeightsAreScaledToSumToOne) {
  Skinned m;
  expect_pose(m.read(m.position() + m.set(0, {0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0},
                                          {3, 0, 0, 0, 0.5f, 1.5f, 0, 0, 0.01f, 0, 0, 0})),
              0, {{10, 0, 0}, {3.5f, 15, 0}, {0, 21, 0}});
}

TEST(GltfSkin, ReadsSeveralSetsOfJoints) {
  Skinned m;
  const std::string first =
      m.set(0, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {0.1f, 0.1f, 0, 0, 0, 0, 0, 0, 0.5f, 0, 0, 0});
  const std::string second = m.set(1, {1, 1, 1, 1, 1, 0, 0, 0, 1, 0, 0, 0},
                                   {0.2f, 0.2f, 0.2f, 0.2f, 1, 0, 0, 0, 0.5f, 0, 0, 0});
  expect_pose(m.read(m.position() + first + second), 0, {{2, 16, 0}, {1, 20, 0}, {5, 11, 0}});
}

TEST(GltfSkin, AVertexWithoutWeightsFollowsTheMeshNode) {
  Skinned m;
  expect_pose(m.read(m.position() + m.set(0, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                          {1, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0})),
              0, {{10, 0, 0}, {1, 0, 100}, {10, 1, 0}});
}

TEST(GltfSkin, ReadsNormalisedIntegerWeightsAndWideJointIndices) {
  Skinned m;
  const int joints = m.b.accessor<std::uint16_t>("VEC4", {0, 1, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0});
  const int weights = m.b.accessor<std::uint8_t>(
      "VEC4", {255, 0, 0, 0, 51, 204, 0, 0, 255, 0, 0, 0}, ", \"normalized\": true");
  expect_pose(m.read(m.position() + Skinned::influences(0, joints, weights)), 0,
              {{10, 0, 0}, {3, 16, 0}, {0, 21, 0}});
}

TEST(GltfSkin, AppliesInverseBindMatricesFirst) {
  Skinned m;
  // Joint 0: scale by 2, then its node's shift. Joint 1: shift by (0, -20, 0), which its node
  // undoes.
  const int inverse_bind =
      m.b.accessor<float>("MAT4", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0,   0, 1,
                                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -20, 0, 1});
  expect_pose(
      m.read(m.position() + m.set(0, {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0},
                                  {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}),
             "",
             "{\"joints\": [1, 2], \"inverseBindMatrices\": " + std::to_string(inverse_bind) + "}"),
      0, {{10, 0, 0}, {12, 0, 0}, {0, 1, 0}});
}

TEST(GltfSkin, MorphsBeforeItSkins) {
  Skinned m;
  const int offsets = m.b.accessor<float>("VEC3", {0, 0, 0, 0, 4, 0, 0, 0, 0});
  m.b.at("nodes", 1) = "{\"scale\": [1, 3, 1]}";
  m.b.at("nodes", 0).insert(1, "\"weights\": [0.5], ");
  // Vertex 1 morphs to (1, 2, 0), then joint 0 stretches y by 3.
  expect_pose(m.read(m.position() + m.set(0, {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0},
                                          {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}),
                     ", \"targets\": [{\"POSITION\": " + std::to_string(offsets) + "}]"),
              0, {{0, 0, 0}, {1, 6, 0}, {0, 21, 0}});
}

TEST(GltfSkin, ASkinnedMeshWithoutJointsFollowsItsNode) {
  Skinned m;
  expect_pose(m.read(m.position()), 0, {{0, 0, 100}, {1, 0, 100}, {0, 1, 100}});
}

TEST(GltfSkin, AMirroredSkeletonTurnsTheTrianglesRound) {
  Skinned m;
  m.b.at("nodes", 1) = "{\"scale\": [1, 1, -1]}";
  const PoseSequence s = m.read(m.position() + m.set(0, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                                     {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}));
  expect_pose(s, 0, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}});  // in the order of first use
}

TEST(GltfSkin, RefusesAJointTheSkinDoesNotHave) {
  Skinned m;
  const std::string attributes = m.position() + m.set(0, {0, 0, 0, 0, 255, 0, 0, 0, 0, 0, 0, 0},
                                                      {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  expect_refused(ErrorCode::kBadInput, {"mesh 0", "joint 255", "skin 0"},
                 [&] { m.read(attributes); });
  // The same number without weight is harmless.
  Skinned unused;
  unused.read(unused.position() + unused.set(0, {0, 255, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                             {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}));
}

TEST(GltfSkin, RefusesNegativeWeightsAndJointsWithoutWeights) {
  Skinned m;
  const std::string negative = m.position() + m.set(0, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},
                                                    {1, 0, 0, 0, 1, -1, 0, 0, 1, 0, 0, 0});
  expect_refused(ErrorCode::kBadInput, {"mesh 0, primitive 0", "negative"},
                 [&] { m.read(negative); });
  Skinned alone;
  const int joints = alone.b.accessor<std::uint8_t>("VEC4", std::vector<std::uint8_t>(12, 0));
  const std::string attributes = alone.position() + ", \"JOINTS_0\": " + std::to_string(joints);
  expect_refused(ErrorCode::kBadInput, {"mesh 0", "joints without weights"},
                 [&] { alone.read(attributes); });
}

TEST(GltfMorph, NodeWeightsGoBeforeMeshWeights) {
  GltfBuilder b;
  const int positions = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int up = b.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  b.mesh("\"POSITION\": " + std::to_string(positions),
         ", \"targets\": [{\"POSITION\": " + std::to_string(up) + "}, {}]");
  b.at("meshes", 0).insert(1, "\"weights\": [2, 9], ");
  b.add("nodes", "{\"mesh\": 0}");
  b.add("nodes", "{\"mesh\": 0, \"weights\": [5, 9]}");
  expect_pose(read_built(b).sequence, 0,
              {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}, {0, 0, 5}, {1, 0, 5}, {0, 1, 5}});
}

TEST(GltfMorph, ReadsNormalisedQuantizedOffsets) {
  GltfBuilder b;
  const int positions = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int view =
      b.view<std::int8_t>({0, 0, 127, 0, 0, 0, -127, 0, 0, 0, 0, 0}, ", \"byteStride\": 4");
  const int offsets = b.add("accessors", "{\"bufferView\": " + std::to_string(view) +
                                             ", \"componentType\": 5120, \"normalized\": true, "
                                             "\"count\": 3, \"type\": \"VEC3\"}");
  b.mesh("\"POSITION\": " + std::to_string(positions),
         ", \"targets\": [{\"POSITION\": " + std::to_string(offsets) + "}]");
  b.add("nodes", "{\"mesh\": 0, \"weights\": [2]}");
  expect_pose(read_built(b).sequence, 0, {{0, 0, 2}, {1, 0, -2}, {0, 1, 0}});
}

TEST(GltfMorph, RefusesWeightsThatDoNotMatchTheTargets) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + ", \"weights\": [1, 2]}");
  expect_refused(ErrorCode::kBadInput, {"node 0", "morph targets"}, [&] { read_built(b); });
}

TEST(GltfSkin, KeepsTheSkeletonThatItsBonesHangOnWhereItIsAskedFor) {
  // Root 0 with joints 1 and 2 in a row; node 3 is no ancestor of anything shown; node 4 the mesh.
  GltfBuilder b;
  const int positions = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  b.add("nodes", R"({"name": "root", "children": [1], "rotation": [0, 0, 0.6, 0.8]})");
  b.add("nodes", R"({"name": "arm", "children": [2], "translation": [1, 2, 3]})");
  b.add("nodes", R"({"name": "hand", "scale": [2, 2, 2], "translation": [0, 1, 0]})");
  b.add("nodes", R"({"name": "lamp"})");
  b.add("nodes", R"({"mesh": 0, "skin": 0})");
  const std::string sets =
      Skinned::influences(0, b.accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}),
                          b.accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}));
  b.mesh("\"POSITION\": " + std::to_string(positions) + sets);
  b.add("skins", R"({"joints": [1, 2]})");
  ReadOptions options;
  EXPECT_FALSE(read_built(b, options).sequence.skeleton.has_value());
  options.skeleton = true;
  const PoseSequence sequence = read_built(b, options).sequence;
  ASSERT_TRUE(sequence.skeleton.has_value());
  const SkeletonView skeleton = sequence.skeleton->view();
  std::vector<std::string> names;
  for (const Joint& joint : skeleton.joints) names.emplace_back(skeleton.name(joint));
  EXPECT_THAT(names, testing::UnorderedElementsAre("root", "arm", "hand", ""));
  for (const Joint& joint : skeleton.joints) {
    if (skeleton.name(joint) == "hand") {
      EXPECT_EQ(names[joint.parent], "arm");
    }
  }
  const SkeletonPose rest{std::vector<Vec3d>(4), {}};
  EXPECT_EQ(bone_maps(skeleton, rest), sequence.rig->bone_maps)
      << "unturned, the bones are the file's";
}

}  // namespace
}  // namespace mdk::test
