// Geometry and the shape of the result: what becomes a triangle, a vertex, a clip.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "formats/gltf/reader.h"
#include "tests/formats/gltf_builder.h"
#include "tests/formats/gltf_expect.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Triangle tri(std::uint32_t a, std::uint32_t b, std::uint32_t c) { return {{a, b, c}}; }

/// A mesh of five points on a line of different heights: any three are told apart.
std::string five_points(GltfBuilder& b) {
  return "\"POSITION\": " +
         std::to_string(b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 2, 1, 0, 3, 1, 0, 4, 2, 0}));
}

TEST(GltfReader, AFileWithoutAnimationIsOneClipOfOneKey) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + "}");
  const ReadResult r = read_built(b);
  EXPECT_THAT(r.sequence.clips, ElementsAre(Clip{"static", 0, 1}));
  EXPECT_THAT(r.sequence.key_times, ElementsAre(0.0));
  EXPECT_THAT(r.sequence.triangles, ElementsAre(tri(0, 1, 2)));
  expect_pose(r.sequence, 0, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  EXPECT_EQ(read_built(b, 30, {"static"}).sequence.clips.size(), 1u);
}

TEST(GltfReader, ReadsBinaryFilesLikeTextFiles) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + ", \"scale\": [2, 3, 4]}");
  const TempFolder folder;
  const std::string path = write_text(folder, "a.glb", b.glb());
  const ReadResult r = read_file(path);
  expect_pose(r.sequence, 0, {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}});
  EXPECT_THAT(r.dependencies, ElementsAre(path));
}

TEST(GltfReader, ListsTheBuffersItReadsAsDependencies) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + "}");
  b.add("buffers", "{\"byteLength\": " + std::to_string(b.bytes().size()) +
                       ", \"uri\": \"parts/my%20mesh.bin\"}");
  const TempFolder folder;
  // Bytes past byteLength are allowed and ignored.
  const std::string bin = write_text(folder, "parts/my mesh.bin", b.bytes() + "padding");
  const std::string path = write_text(folder, "a.gltf", b.json());
  EXPECT_THAT(read_file(path).dependencies, ElementsAre(path, bin));
}

TEST(GltfReader, UnrollsStripsWithEverySecondTriangleTurned) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.mesh(five_points(b), ", \"mode\": 5")) + "}");
  EXPECT_THAT(read_built(b).sequence.triangles,
              ElementsAre(tri(0, 1, 2), tri(1, 3, 2), tri(2, 3, 4)));
}

TEST(GltfReader, UnrollsIndexedFansAroundTheirFirstVertex) {
  GltfBuilder b;
  const std::string attributes = five_points(b);
  const int indices = b.accessor<std::uint8_t>("SCALAR", {4, 0, 1, 2});
  b.add("nodes", "{\"mesh\": " +
                     std::to_string(b.mesh(
                         attributes, ", \"mode\": 6, \"indices\": " + std::to_string(indices))) +
                     "}");
  const PoseSequence s = read_built(b).sequence;
  // Fan triangles are (i + 1, i + 2, first): vertices in the order of first use are 0, 1, 4, 2.
  EXPECT_THAT(s.triangles, ElementsAre(tri(0, 1, 2), tri(1, 3, 2)));
  expect_pose(s, 0, {{0, 0, 0}, {1, 0, 0}, {4, 2, 0}, {2, 1, 0}});
}

TEST(GltfReader, LeavesOutPointsAndLinesWithANote) {
  GltfBuilder b;
  const std::string attributes = five_points(b);
  b.add("meshes", "{\"primitives\": [{\"mode\": 1, \"attributes\": {" + attributes +
                      "}}, {\"mode\": 0, \"attributes\": {" + attributes +
                      "}}, {\"mode\": 5, \"attributes\": {" + attributes + "}}]}");
  b.add("nodes", "{\"mesh\": 0}");
  const ReadResult r = read_built(b);
  EXPECT_EQ(r.sequence.triangles.size(), 3u);
  EXPECT_THAT(r.notes, ElementsAre("points and lines are left out"));
}

TEST(GltfReader, AFileOfPointsAloneIsRefused) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.mesh(five_points(b), ", \"mode\": 0")) + "}");
  expect_refused(ErrorCode::kBadInput, {"test.gltf", "no triangles"}, [&] { read_built(b); });
}

TEST(GltfReader, AppliesTheNodeHierarchyFromRootToLeaf) {
  GltfBuilder b;
  const std::string mesh = std::to_string(b.triangle_mesh());
  b.add("nodes", "{\"mesh\": " + mesh + ", \"scale\": [2, 2, 2]}");
  // A quarter turn about z: x becomes y, y becomes -x.
  b.add("nodes",
        "{\"children\": [0], \"rotation\": [0, 0, 0.70710678118654752, 0.70710678118654752]}");
  b.add("nodes", "{\"children\": [1], \"matrix\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 10,20,30,1]}");
  expect_pose(read_built(b).sequence, 0, {{10, 20, 30}, {10, 22, 30}, {8, 20, 30}});
}

TEST(GltfReader, ShowsTheDefaultSceneOnly) {
  GltfBuilder b;
  const std::string mesh = std::to_string(b.triangle_mesh());
  b.add("nodes", "{\"mesh\": " + mesh + ", \"translation\": [1, 0, 0]}");
  b.add("nodes", "{\"mesh\": " + mesh + ", \"translation\": [2, 0, 0]}");
  b.add("scenes", "{\"nodes\": [0]}");
  b.add("scenes", "{\"nodes\": [1]}");
  b.set("scene", "1");
  expect_pose(read_built(b).sequence, 0, {{2, 0, 0}, {3, 0, 0}, {2, 1, 0}});
  b.set("scene", "0");
  expect_pose(read_built(b).sequence, 0, {{1, 0, 0}, {2, 0, 0}, {1, 1, 0}});
}

TEST(GltfReader, AMeshShownTwiceBecomesTwoSetsOfTriangles) {
  GltfBuilder b;
  const std::string mesh = std::to_string(b.triangle_mesh());
  b.add("nodes", "{\"mesh\": " + mesh + "}");
  b.add("nodes", "{\"mesh\": " + mesh + ", \"translation\": [0, 0, 5]}");
  const PoseSequence s = read_built(b).sequence;
  EXPECT_THAT(s.triangles, ElementsAre(tri(0, 1, 2), tri(3, 4, 5)));
  expect_pose(s, 0, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 5}, {1, 0, 5}, {0, 1, 5}});
  EXPECT_EQ(s.triangle_meshes, (std::vector<std::uint32_t>{0, 1}));
}

TEST(GltfReader, AMirroredNodeKeepsItsTrianglesFacingOutside) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + ", \"scale\": [1, 1, -1]}");
  const PoseSequence s = read_built(b).sequence;
  const auto p = s.pose(0);
  const Triangle& t = s.triangles[0];
  const Vec3f normal = cross(p[t.v[1]] - p[t.v[0]], p[t.v[2]] - p[t.v[0]]);
  // The triangle faced +z; mirroring along z makes that -z.
  EXPECT_LT(normal.z, 0);
}

TEST(GltfReader, TwoMirrorsInARowCancel) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + ", \"scale\": [1, 1, -1]}");
  b.add("nodes", "{\"children\": [0], \"scale\": [-1, 1, 1]}");
  EXPECT_THAT(read_built(b).sequence.triangles, ElementsAre(tri(0, 1, 2)));
  expect_pose(read_built(b).sequence, 0, {{0, 0, 0}, {-1, 0, 0}, {0, 1, 0}});
}

TEST(GltfReader, ReadsInterleavedPositions) {
  GltfBuilder b;
  const int view = b.view<float>({9, 0, 0, 0, 9, 1, 0, 0, 9, 0, 1, 0}, ", \"byteStride\": 16");
  const int positions = b.add(
      "accessors", "{\"bufferView\": " + std::to_string(view) +
                       ", \"byteOffset\": 4, \"componentType\": 5126, \"count\": 3, \"type\": "
                       "\"VEC3\"}");
  b.add("nodes",
        "{\"mesh\": " + std::to_string(b.mesh("\"POSITION\": " + std::to_string(positions))) + "}");
  expect_pose(read_built(b).sequence, 0, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
}

TEST(GltfReader, SparseAccessorsReplaceSomeElements) {
  GltfBuilder b;
  const int indices = b.view<std::uint16_t>({1, 2});
  const int values = b.view<float>({5, 6, 7, -1, -2, -3});
  const std::string sparse =
      ", \"sparse\": {\"count\": 2, \"indices\": {\"bufferView\": " + std::to_string(indices) +
      ", \"componentType\": 5123}, \"values\": {\"bufferView\": " + std::to_string(values) + "}}";
  const int dense = b.accessor<float>("VEC3", {1, 1, 1, 2, 2, 2, 3, 3, 3}, sparse);
  // Without a buffer view the elements that are not replaced are zero.
  const int zeros = b.add(
      "accessors", "{\"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"" + sparse + "}");
  b.add("nodes",
        "{\"mesh\": " + std::to_string(b.mesh("\"POSITION\": " + std::to_string(dense))) + "}");
  b.add("nodes",
        "{\"mesh\": " + std::to_string(b.mesh("\"POSITION\": " + std::to_string(zeros))) + "}");
  const PoseSequence s = read_built(b).sequence;
  // Both meshes share the replaced corners, which weld.
  expect_pose(s, 0, {{1, 1, 1}, {5, 6, 7}, {-1, -2, -3}, {0, 0, 0}});
  EXPECT_THAT(s.triangles, ElementsAre(tri(0, 1, 2), tri(3, 1, 2)));
}

TEST(GltfReader, ReadsQuantizedPositions) {
  GltfBuilder b;
  b.set("extensionsRequired", "[\"KHR_mesh_quantization\"]");
  const int bytes = b.add(
      "accessors",
      "{\"bufferView\": " +
          std::to_string(b.view<std::int8_t>({0, 0, 0, 0, 127, 0, 0, 0, 0, -128, 64, 0},
                                             ", \"byteStride\": 4")) +
          ", \"componentType\": 5120, \"normalized\": true, \"count\": 3, \"type\": \"VEC3\"}");
  const int shorts = b.add(
      "accessors", "{\"bufferView\": " +
                       std::to_string(b.view<std::uint16_t>(
                           {0, 0, 0, 0, 65535, 0, 0, 0, 0, 300, 0, 0}, ", \"byteStride\": 8")) +
                       ", \"componentType\": 5123, \"count\": 3, \"type\": \"VEC3\"}");
  b.add("nodes",
        "{\"mesh\": " + std::to_string(b.mesh("\"POSITION\": " + std::to_string(bytes))) + "}");
  b.add("nodes",
        "{\"mesh\": " + std::to_string(b.mesh("\"POSITION\": " + std::to_string(shorts))) + "}");
  // -128 stands for -1 like -127 does; 64 / 127 is not one half.
  expect_pose(read_built(b).sequence, 0,
              {{0, 0, 0}, {1, 0, 0}, {0, -1, 64.0f / 127}, {65535, 0, 0}, {0, 300, 0}});
}

TEST(GltfReader, VerticesWithTheSamePathAndNormalAreJoined) {
  GltfBuilder b;
  const int positions =
      b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, /**/ 0, 1, 0, 1, 0, 0, 1, 1, 0});
  const int smooth =
      b.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int hard =
      b.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 1, 0, 0, 1, 0});
  const auto with = [&](int normals) {
    GltfBuilder copy = b;
    copy.mesh("\"POSITION\": " + std::to_string(positions) +
              (normals < 0 ? "" : ", \"NORMAL\": " + std::to_string(normals)));
    copy.add("nodes", "{\"mesh\": 0}");
    return read_built(copy).sequence;
  };
  EXPECT_THAT(with(smooth).triangles, ElementsAre(tri(0, 1, 2), tri(2, 1, 3)));
  EXPECT_THAT(with(hard).triangles, ElementsAre(tri(0, 1, 2), tri(3, 4, 5)));
  EXPECT_THAT(with(-1).triangles, ElementsAre(tri(0, 1, 2), tri(2, 1, 3)));
  EXPECT_EQ(with(smooth).appearance.materials[0].flags, 0u);
  EXPECT_EQ(with(-1).appearance.materials[0].flags, kMaterialFlatShaded);
}

TEST(GltfReader, KeepsDegenerateTrianglesInTheirPlace) {
  GltfBuilder b;
  const std::string attributes = five_points(b);
  const int indices = b.accessor<std::uint32_t>("SCALAR", {0, 1, 2, 1, 1, 3, 2, 3, 4});
  b.add("nodes",
        "{\"mesh\": " +
            std::to_string(b.mesh(attributes, ", \"indices\": " + std::to_string(indices))) + "}");
  EXPECT_THAT(read_built(b).sequence.triangles,
              ElementsAre(tri(0, 1, 2), tri(1, 1, 3), tri(2, 3, 4)));
}

TEST(GltfReader, AScaleOfZeroIsLegal) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + ", \"scale\": [0, 0, 0]}");
  const PoseSequence s = read_built(b).sequence;
  EXPECT_THAT(s.pose(0), ElementsAre(Vec3f{}, Vec3f{}, Vec3f{}));
}

TEST(GltfReader, NamesTheExtensionItCannotRead) {
  for (const std::string name : {"EXT_mesh_gpu_instancing", "EXT_something_new"}) {
    GltfBuilder b;
    b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + "}");
    b.set("extensionsRequired", "[\"" + name + "\"]");
    expect_refused(ErrorCode::kBadInput, {"test.gltf", name, "export it again"},
                   [&] { read_built(b); });
  }
}

TEST(GltfReader, NotesExtensionsThatAreUsedButNotRequired) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + "}");
  b.set("extensionsUsed", "[\"KHR_materials_clearcoat\", \"EXT_mesh_gpu_instancing\"]");
  EXPECT_THAT(read_built(b).notes, ElementsAre(HasSubstr("EXT_mesh_gpu_instancing")));
}

TEST(GltfReader, ReportsProgressFromZeroToOneWithoutGoingBack) {
  struct Recorder final : ProgressSink {
    void report(std::string_view stage, double fraction) override {
      EXPECT_EQ(stage, "read");
      fractions.push_back(fraction);
    }
    std::vector<double> fractions;
  };
  GltfBuilder b;
  const std::string mesh = std::to_string(b.triangle_mesh());
  b.add("nodes", "{\"mesh\": " + mesh + "}");
  const int times = b.accessor<float>("SCALAR", {0, 10});
  b.animation(0, "translation", times, b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0}));
  const TempFolder folder;
  Recorder recorder;
  read_gltf(write_text(folder, "a.gltf", b.json()), {}, recorder);
  EXPECT_GT(recorder.fractions.size(), 4u);
  EXPECT_EQ(recorder.fractions.front(), 0.0);
  EXPECT_EQ(recorder.fractions.back(), 1.0);
  EXPECT_TRUE(std::is_sorted(recorder.fractions.begin(), recorder.fractions.end()));
}

}  // namespace
}  // namespace mdk::test
