#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "formats/mesh/reader.h"
#include "formats/mesh/triangle_mesh.h"
#include "tests/formats/ply_builder.h"
#include "tests/formats/sample_data.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

class MeshSequenceData : public SampleData {
 protected:
  void SetUp() override {
    SampleData::SetUp();
    if (!IsSkipped() && !std::filesystem::exists(need("sequences/cow_obj/24.obj")))
      GTEST_SKIP() << "no numbered files in the sample data";
  }
  ReadResult cow() {
    return read_mesh_sequence(files_of_pattern(need("sequences/cow_obj/####.obj")), {}, silent_);
  }

  SilentProgress silent_;
};

/// The largest distance of any corner at any key of both.
float largest_distance(const PoseSequence& a, const PoseSequence& b) {
  float largest = 0;
  for (std::uint32_t k = 0; k < std::min(a.key_count(), b.key_count()); ++k)
    for (std::size_t t = 0; t < a.triangles.size(); ++t)
      for (int c = 0; c < 3; ++c)
        largest = std::max(largest,
                           length(a.pose(k)[a.triangles[t].v[c]] - b.pose(k)[b.triangles[t].v[c]]));
  return largest;
}

TEST_F(MeshSequenceData, NumberedFilesAreThePointCacheMadeFromThem) {
  const PoseSequence numbered = cow().sequence;
  const PoseSequence cached =
      read_cached_mesh(need("sequences/cow.obj"), need("sequences/cow.pc2"), {}, silent_).sequence;
  ASSERT_EQ(numbered.key_count(), 24u);
  ASSERT_EQ(numbered.triangles.size(), cached.triangles.size());
  EXPECT_LE(largest_distance(numbered, cached), 2e-7f);
}

TEST_F(MeshSequenceData, AsPlyOfAnyEncodingTheyAreTheSameToTheBit) {
  const PoseSequence numbered = cow().sequence;
  for (const PlyEncoding encoding : {PlyEncoding::kLittleEndian, PlyEncoding::kBigEndian}) {
    const TempFolder folder;
    for (int i = 1; i <= 24; ++i) {
      const TriangleMesh mesh =
          read_mesh(need("sequences/cow_obj/" + std::to_string(i) + ".obj"), ObjContent::kShape);
      PlyBuilder ply(encoding, "element vertex " + std::to_string(mesh.vertices.size()) +
                                   "\nproperty float x\nproperty float y\nproperty float z\n"
                                   "element face " +
                                   std::to_string(mesh.triangles.size()) +
                                   "\nproperty list uchar int vertex_indices\n");
      for (const Vec3f& v : mesh.vertices) ply.number(v.x).number(v.y).number(v.z);
      for (const Triangle& t : mesh.triangles) {
        ply.number(std::uint8_t{3});
        for (const std::uint32_t v : t.v) ply.number(v);
      }
      write_text(folder.file(std::to_string(i) + ".ply"), ply.file());
    }
    const PoseSequence again =
        read_mesh_sequence(files_of_pattern(folder.file("#.ply")), {}, silent_).sequence;
    EXPECT_EQ(again.triangles, numbered.triangles);
    EXPECT_EQ(again.positions, numbered.positions);
  }
}

}  // namespace
}  // namespace mdk::test
