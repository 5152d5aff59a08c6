#include <gmock/gmock.h>

#include "formats/mesh/triangle_mesh.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ObjReader : public testing::Test {
 protected:
  TriangleMesh read(const std::string& text) {
    const std::string path = folder_.file("mesh.obj");
    write_bytes(path, Bytes(text.begin(), text.end()));
    return read_mesh(path, ObjContent::kShapeAndMaterials);
  }
  void expect_bad(const std::string& text, const std::string& words) {
    expect_error(ErrorCode::kBadInput, words, [&] { read(text); });
  }

  TempFolder folder_;
};

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(ObjReader, VerticesAndTrianglesAreThoseOfTheFile) {
  const TriangleMesh mesh =
      read("# a triangle\no t\nv 0 0.1 -2e-3\nv +1 0 0 1.0\n\tv 0 1 .5\nf 1 2 3\n");
  EXPECT_THAT(mesh.vertices,
              ElementsAre(Vec3f{0, 0.1f, -2e-3f}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0.5f}));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{{0, 1, 2}}));
  EXPECT_THAT(mesh.vertex_colors, IsEmpty());
}

TEST_F(ObjReader, APolygonIsAFanWhateverItsShape) {
  const std::string dart = "v 0 0 0\nv 2 0 0\nv 0.5 0.5 0\nv 0 2 0\n";  // not convex at the third
  EXPECT_THAT(read(kSquare + "f 1 2 3 4\n").triangles,
              ElementsAre(Triangle{{0, 1, 2}}, Triangle{{0, 2, 3}}));
  EXPECT_EQ(read(dart + "f 1 2 3 4\n").triangles, read(kSquare + "f 1 2 3 4\n").triangles);
}

TEST_F(ObjReader, CornersMayNameTexcoordsAndNormalsAndCountBackwards) {
  const std::vector<Triangle> expected = {{{0, 1, 3}}};
  for (const char* face : {"f 1 2 4", "f 1/1 2/2 4/3", "f 1//1 2//1 4//1", "f 1/1/1 2/1/1 4/1/1",
                           "f -4 -3 -1", "f -4/-1 -3/-1 -1/-1", "f 1 2 \\\n 4", "f 1 2 \\\r\n 4\r"})
    EXPECT_EQ(read(kSquare + face + "\n").triangles, expected) << face;
  EXPECT_EQ(read("f 1 2 4\n" + kSquare).triangles, expected) << "faces before their vertices";
}

TEST_F(ObjReader, ColoursAfterTheCoordinatesAreSrgb) {
  const TriangleMesh mesh = read("v 0 0 0\nv 1 0 0 1 0.5 0\nv 1 1 0 2 -1 0.02\nf 1 2 3\n");
  // 0.5 in sRGB is 0.214 of the light, 0.02 lies on the straight part of the curve.
  EXPECT_THAT(mesh.vertex_colors,
              ElementsAre(0xffffffffu, 0xff00'0000u | 55u << 8 | 255u, 0xff00'00ffu));
}

TEST_F(ObjReader, FacesNameTheirMaterialsAndCornersTheirTexcoords) {
  const std::string text =
      "mtllib my colours.mtl\n" + kSquare +
      "f 1 2 3\nvt 0.5 0.25\nusemtl  dark red \nf 1/1 2/-1 3/2 4\nusemtl b\nf 1/9 2/x 3/1/1\n"
      "usemtl dark red\nf 2 3 4\nvt 1 1\n";
  const TriangleMesh mesh = read(text);
  EXPECT_THAT(mesh.materials.libraries, ElementsAre("my colours.mtl"));
  EXPECT_THAT(mesh.materials.names, ElementsAre("", "dark red", "b"));
  EXPECT_THAT(mesh.materials.triangles, ElementsAre(0, 1, 1, 2, 1));
  ASSERT_EQ(mesh.materials.corners.size(), 15u);
  EXPECT_EQ(mesh.materials.corners[3].u, 0.5f) << "of the file's own first";
  EXPECT_EQ(mesh.materials.corners[4].v, 0.75f) << "v runs downwards here, upwards in the file";
  EXPECT_EQ(mesh.materials.corners[5].u, 1.0f) << "one that comes after its face";
  EXPECT_EQ(mesh.materials.corners[9].u, 0.0f) << "one that is not there";
  EXPECT_TRUE(mesh.materials.is_missing_texcoords);
  EXPECT_THAT(parse_obj("a.obj", text, ObjContent::kShape).materials.names, IsEmpty());
}

TEST_F(ObjReader, AByteOrderMarkHidesNoVertex) {
  EXPECT_EQ(read("\xef\xbb\xbf" + kSquare + "f 1 2 3 4\n").vertices.size(), 4u);
}

TEST_F(ObjReader, AWordWithAZeroByteDoesNotCutTheSentenceShort) {
  expect_bad(kSquare + std::string("f 1 2\0\x1b 3\n", 11),
             "line 5: \"2??\" is not the number of a vertex");
}

TEST_F(ObjReader, WhatIsBrokenIsRefusedWithItsLine) {
  expect_bad("", "has no faces");
  expect_bad(kSquare, "has no faces");
  expect_bad(kSquare + "f 1 2\n", "line 5: a face needs three corners");
  expect_bad(kSquare + "f\n", "line 5: a face needs three corners");
  expect_bad("v 0 0\n", "line 1: a vertex needs three coordinates");
  expect_bad("\n# x\nv 0 zero 0\n", "line 3: \"zero\" is not a finite number");
  expect_bad("v 0 nan 0\n", "line 1: \"nan\" is not a finite number");
  expect_bad("v 0 inf 0\n", "line 1: \"inf\" is not a finite number");
  expect_bad("v 0 1e99 0\n", "line 1: \"1e99\" is not a finite number");
  expect_bad("v 0 0x10 0\n", "line 1: \"0x10\" is not a finite number");
  for (const char* corner : {"0", "1.5", "x", "/1", "99999999999999999999", "--1"})
    expect_bad(kSquare + "f 1 2 " + corner + "\n", "line 5: ");
  for (const char* corner : {"5", "-5", "4294967297", "-4294967295", "134217728"})
    expect_bad(kSquare + "f 1 2 " + corner + "\nf 1 2 3\n",
               std::string("line 5: a face has the corner \"") + corner);
  expect_bad("f 1 \\\n 2 \\\n 9\n" + kSquare, "line 1: a face has the corner \"9\"");
}

TEST_F(ObjReader, AnyCutOrFlippedByteIsReadOrRefusedInOneSentence) {
  const std::string whole = "v 0 0 0 1 1 1\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf -1 -2 -3\n";
  const auto try_text = [&](const std::string& text) {
    try {
      for (const Triangle& t : read(text).triangles)
        for (const std::uint32_t v : t.v) ASSERT_LT(v, 40u);
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
    }
  };
  for (std::size_t size = 0; size <= whole.size(); ++size) try_text(whole.substr(0, size));
  for (std::size_t at = 0; at < whole.size(); ++at)
    for (const char c : {'\0', '\n', ' ', '-', '9', 'f', '\\', '/', '\x80'}) {
      std::string text = whole;
      text[at] = c;
      try_text(text);
    }
}

TEST_F(ObjReader, AFileThatIsNotThereIsAnIoError) {
  expect_error(ErrorCode::kIo, "none.obj",
               [&] { read_mesh(folder_.file("none.obj"), ObjContent::kShape); });
  expect_error(ErrorCode::kIo, "folder", [&] { read_mesh(folder_.path(), ObjContent::kShape); });
}

}  // namespace
}  // namespace mdk::test
