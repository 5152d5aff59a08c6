// Legal glTF that loaders are known to get wrong, beside what the other tests hold already.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/formats/gltf_builder.h"
#include "tests/formats/gltf_expect.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;

const std::string kTwoJoints = "{\"joints\": [1, 2]}";

/// The unit triangle on node 0, its vertices on the joints 0, 1 and 0 of skin 0.
class Trap {
 public:
  /// `nodes`: from 1 on.
  explicit Trap(const std::vector<std::string>& nodes, const std::string& skin = kTwoJoints) {
    const int positions = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int joints = b.accessor<std::uint8_t>("VEC4", {0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0});
    const int weights = b.accessor<float>("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
    b.mesh("\"POSITION\": " + std::to_string(positions) + ", \"JOINTS_0\": " +
           std::to_string(joints) + ", \"WEIGHTS_0\": " + std::to_string(weights));
    b.add("nodes", "{\"mesh\": 0, \"skin\": 0}");
    for (const std::string& node : nodes) b.add("nodes", node);
    b.add("skins", skin);
  }

  /// From the origin at 0 s to `to` at 1 s.
  void move(int node, const std::vector<float>& to) {
    std::vector<float> values = {0, 0, 0};
    values.insert(values.end(), to.begin(), to.end());
    const int times = b.accessor<float>("SCALAR", {0, 1});
    b.animation(node, "translation", times, b.accessor<float>("VEC3", values));
  }
  PoseSequence read() const { return read_built(b, 1).sequence; }

  GltfBuilder b;
};

TEST(GltfTraps, ASkeletonIsCarriedByWhatStandsAboveItsRoot) {
  Trap trap({"{}",                       // 1: a joint
             "{}",                       // 2: a joint
             "{\"children\": [1, 2]}"},  // 3: no joint, and it moves
            "{\"joints\": [1, 2], \"skeleton\": 1}");
  trap.move(3, {7, 0, 0});
  expect_pose(trap.read(), 0, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  expect_pose(trap.read(), 1, {{7, 0, 0}, {8, 0, 0}, {7, 1, 0}});
}

TEST(GltfTraps, ANodeBetweenTwoJointsMovesTheLowerThoughNoSkinNamesIt) {
  Trap trap({"{\"children\": [2]}",  // 1: a joint
             "{\"children\": [3]}",  // 2: between, and it moves
             "{}"},                  // 3: a joint
            "{\"joints\": [1, 3]}");
  trap.move(2, {0, 0, 5});
  expect_pose(trap.read(), 1, {{0, 0, 0}, {1, 0, 5}, {0, 1, 0}});
}

TEST(GltfTraps, ASkinnedMeshBelowItsOwnJointMovesOnce) {
  Trap trap({"{\"children\": [0]}", "{}"});
  trap.move(1, {0, 3, 0});
  expect_pose(trap.read(), 1, {{0, 3, 0}, {1, 0, 0}, {0, 4, 0}});
}

TEST(GltfTraps, SkinsMayShareJointsInAnotherOrderAndWithOtherBindings) {
  Trap trap({"{\"translation\": [10, 0, 0]}", "{\"translation\": [0, 20, 0]}",
             "{\"mesh\": 0, \"skin\": 1}"});
  const int bindings =
      trap.b.accessor<float>("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,   -20, 0, 1,
                                      1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -10, 0,   3, 1});
  trap.b.add("skins",
             "{\"joints\": [2, 1], \"inverseBindMatrices\": " + std::to_string(bindings) + "}");
  expect_pose(trap.read(), 0,
              {{10, 0, 0}, {1, 20, 0}, {10, 1, 0}, {0, 0, 0}, {1, 0, 3}, {0, 1, 0}});
}

TEST(GltfTraps, WithoutInverseBindMatricesJointsStandWhereTheMeshIs) {
  const Trap trap({"{\"translation\": [1, 2, 3]}", "{\"scale\": [4, 1, 1]}"});
  expect_pose(trap.read(), 0, {{1, 2, 3}, {4, 0, 0}, {1, 3, 3}});
}

TEST(GltfTraps, MorphWeightsFollowCubicSplines) {
  GltfBuilder b;
  const int positions = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int up = b.accessor<float>("VEC3", {0, 0, 2, 0, 0, 2, 0, 0, 2});
  const int away = b.accessor<float>("VEC3", {4, 0, 0, 4, 0, 0, 4, 0, 0});
  b.mesh("\"POSITION\": " + std::to_string(positions),
         ", \"targets\": [{\"POSITION\": " + std::to_string(up) +
             "}, {\"POSITION\": " + std::to_string(away) + "}]");
  b.add("nodes", "{\"mesh\": 0}");
  // Per key: tangents in, values, tangents out, each of both targets. In the middle of two seconds
  // a Hermite curve is (p0 + p1) / 2 + 2 (m0 - m1) / 8.
  const int values = b.accessor<float>("SCALAR", {9, 9, 0, 1, 2, 0, -2, 4, 1, 1, 9, 9});
  b.animation(0, "weights", b.accessor<float>("SCALAR", {0, 2}), values, "CUBICSPLINE");
  const PoseSequence s = read_built(b, 1).sequence;
  // up: 1/2 + (2 + 2) / 4 = 1.5; away: 1 + (0 - 4) / 4 = 0.
  expect_pose(s, 1, {{0, 0, 3}, {1, 0, 3}, {0, 1, 3}});
  expect_pose(s, 2, {{4, 0, 2}, {5, 0, 2}, {4, 1, 2}});
}

TEST(GltfTraps, ClipsKeepTheirOwnLengths) {
  Trap trap({"{}", "{}"});
  trap.move(1, {1, 0, 0});
  const int times = trap.b.accessor<float>("SCALAR", {2, 5});
  trap.b.animation(2, "translation", times, trap.b.accessor<float>("VEC3", {0, 0, 0, 3, 0, 0}));
  const PoseSequence s = trap.read();
  EXPECT_THAT(s.clips, ElementsAre(Clip{"clip 1", 0, 2}, Clip{"clip 2", 2, 4}));
  EXPECT_THAT(s.key_times, ElementsAre(0, 1, 0, 1, 2, 3));
  expect_pose(s, 4, {{0, 0, 0}, {3, 0, 0}, {0, 1, 0}});
}

TEST(GltfTraps, AMirroringMatrixTurnsTrianglesLikeANegativeScale) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) +
                     ", \"matrix\": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}");
  expect_pose(read_built(b).sequence, 0, {{5, 0, 0}, {5, 1, 0}, {4, 0, 0}});
}

TEST(GltfTraps, NamesMayBePercentEncodedOrUtf8) {
  const TempFolder folder;
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + "}");
  const auto read_as = [&](const std::string& uri, const std::string& file) {
    SCOPED_TRACE(uri);
    GltfBuilder with_file = b;
    with_file.add("buffers", "{\"byteLength\": " + std::to_string(b.bytes().size()) +
                                 ", \"uri\": \"" + uri + "\"}");
    write_text(folder, file, b.bytes());
    const ReadResult r = read_file(write_text(folder, "räder 1.gltf", with_file.json()));
    EXPECT_EQ(r.sequence.triangles.size(), 1u);
    EXPECT_THAT(r.dependencies, ElementsAre(folder.file("räder 1.gltf"), folder.file(file)));
  };
  read_as("my%20data.bin", "my data.bin");
  read_as("my own.bin", "my own.bin");
  read_as("k%C3%BChe.bin", "kühe.bin");
  read_as("牛.bin", "牛.bin");
  read_as("\\u725b2.bin", "牛2.bin");
  read_as("100%.bin", "100%.bin");
  read_as("sub/./a%2Bb.bin", "sub/a+b.bin");
}

}  // namespace
}  // namespace mdk::test
