#include <gmock/gmock.h>

#include <limits>

#include "formats/mesh/triangle_mesh.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/ply_builder.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr PlyEncoding kEncodings[] = {PlyEncoding::kText, PlyEncoding::kLittleEndian,
                                      PlyEncoding::kBigEndian};

/// A square with colours, among properties and elements that mean nothing here.
std::string square(PlyEncoding encoding) {
  PlyBuilder ply(encoding,
                 "comment made by a test\nobj_info none\n"
                 "element camera 2\nproperty list uchar double view\nproperty char on\n"
                 "element vertex 4\nproperty float nx\nproperty float x\nproperty double y\n"
                 "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                 "property list ushort short rings\n"
                 "element face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\n"
                 "element nothing 18446744073709551615\n");
  using Byte = std::uint8_t;
  ply.number(Byte{2}).number(0.5).number(1.5).number(std::int8_t{-1});
  ply.number(Byte{0}).number(std::int8_t{1});
  const float corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (const auto& corner : corners) {
    ply.number(9.0f).number(corner[0]).number(static_cast<double>(corner[1])).number(-0.25f);
    ply.number(Byte{255}).number(Byte{128}).number(Byte{0});
    ply.number(std::uint16_t{2}).number(std::int16_t{-3}).number(std::int16_t{300});
  }
  ply.number(Byte{1}).number(Byte{4});
  for (const std::int32_t corner : {0, 1, 2, 3}) ply.number(corner);
  ply.number(Byte{1}).number(Byte{3});
  for (const std::int32_t corner : {2, 1, 0}) ply.number(corner);
  return ply.file();
}

const std::string kTriangleLines =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_index\n";

/// One triangle; its numbers as words.
std::string triangle(const std::string& body = "0 0 0 1 0 0 0 1 0 3 0 1 2") {
  return "ply\nformat ascii 1.0\n" + kTriangleLines + "end_header\n" + body;
}

void expect_bad(const std::string& file, const std::string& words) {
  expect_error(ErrorCode::kBadInput, words, [&] { parse_ply("mesh.ply", file); });
}

TEST(PlyReader, EveryEncodingGivesTheSameMesh) {
  for (const PlyEncoding encoding : kEncodings) {
    SCOPED_TRACE(static_cast<int>(encoding));
    const TriangleMesh mesh = parse_ply("square.ply", square(encoding));
    EXPECT_THAT(mesh.vertices, ElementsAre(Vec3f{0, 0, -0.25f}, Vec3f{1, 0, -0.25f},
                                           Vec3f{1, 1, -0.25f}, Vec3f{0, 1, -0.25f}));
    EXPECT_THAT(mesh.triangles,
                ElementsAre(Triangle{{0, 1, 2}}, Triangle{{0, 2, 3}}, Triangle{{2, 1, 0}}));
    // 128 / 255 in sRGB is 0.2159 of the light.
    EXPECT_THAT(mesh.vertex_colors, testing::Each(0xff00'0000u | 55u << 8 | 255u));
  }
}

TEST(PlyReader, PolygonsAreTheFansThatAnObjGives) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n"
      "property float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n"
      "0 0 0\n2 0 0\n0.1 0.1 1e-60\n0 2 0\n-1 1 0\n5 4 0 1 2 3\n";
  const std::string obj = "v 0 0 0\nv 2 0 0\nv 0.1 0.1 1e-60\nv 0 2 0\nv -1 1 0\nf 5 1 2 3 4\n";
  const TriangleMesh a = parse_ply("a.ply", ply), b = parse_obj("b.obj", obj, ObjContent::kShape);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_THAT(a.vertex_colors, IsEmpty());
}

TEST(PlyReader, FacesMayComeFirstAndLinesMayEndLikeWindows) {
  std::string file =
      "ply\r\nformat ascii 1.0\r\nelement face 1\r\n"
      "property list uint8 uint32 vertex_indices\r\nelement vertex 3\r\n"
      "property float32 x\r\nproperty float32 y\r\nproperty float32 z\r\n"
      "end_header\r\n3 0 1 2\r\n0 0 0\r\n1 0 0\r\n0 1 0\r\n";
  EXPECT_THAT(parse_ply("a.ply", file).triangles, ElementsAre(Triangle{{0, 1, 2}}));
}

TEST(PlyReader, ColoursMayBeRealNumbers) {
  PlyBuilder ply(PlyEncoding::kBigEndian,
                 "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                 "property float red\nproperty float green\nproperty float blue\n"
                 "element face 1\nproperty list uchar int vertex_indices\n");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < 3; ++i)
    for (const float number : {float(i), float(i * i), 0.f, 1.f, 0.5f, nan}) ply.number(number);
  ply.number(std::uint8_t{3}).number(0).number(1).number(2);
  EXPECT_THAT(parse_ply("a.ply", ply.file()).vertex_colors,
              testing::Each(0xff00'0000u | 55u << 8 | 255u));
}

TEST(PlyReader, WhatIsBrokenIsRefusedWithItsPlace) {
  EXPECT_EQ(parse_ply("good.ply", triangle()).triangles.size(), 1u);
  expect_bad("", "not a PLY file");
  expect_bad("plywood\n", "not a PLY file");
  expect_bad("ply\nformat ascii 1.0\n", "ends within its header");
  expect_bad("ply\nend_header\n", "no format line");
  expect_bad("ply\nformat ascii 1.1\n", "line 2: version \"1.1\"");
  expect_bad("ply\nformat utf8 1.0\n", "\"utf8\" is no PLY format");
  expect_bad("ply\nproperty float x\n", "line 2: a property comes before");
  expect_bad("ply\nelement vertex -1\n", "line 2: an element needs");
  expect_bad("ply\nelement v 1\nproperty real x\n", "line 3: \"real\" is no type");
  expect_bad("ply\nelement v 1\nproperty list float int x\n", "cannot count in real numbers");
  expect_bad("ply\nelement v 1\nproperty float\n", "line 3: a property needs a name");
  expect_bad("ply\nvertices 7\n", "\"vertices\" is no keyword");
  expect_bad(triangle("0 0 0 1 0 0 0 x 0 3 0 1 2"), "\"vertex\" 2: \"x\" is not a number");
  expect_bad(triangle("0 0 0 1 0 0 0 nan 0 3 0 1 2"), "\"vertex\" 2: has a coordinate");
  expect_bad(triangle("0 0 0 1 0 0 0 1e40 0 3 0 1 2"), "\"vertex\" 2: \"1e40\" is not a number");
  expect_bad(triangle("0 0 0 1 0 0 0 1 0 2 0 1"), "\"face\" 0: a face needs three corners");
  expect_bad(triangle("0 0 0 1 0 0 0 1 0 -3 0 1"), "\"face\" 0: has a list of a negative");
  expect_bad(triangle("0 0 0 1 0 0 0 1 0 3 0 1"), "\"face\" 0: the file is cut short");
  expect_bad(triangle("0 0 0 1 0 0 0 1 0 3 0 1 2.5"), "\"2.5\" is not a whole number");
  expect_bad(triangle("0 0 0 1 0 0 0 1 0 3 0 1 3"), "corner 3, which the file has no vertex for");
  expect_bad(triangle("0 0 0 1 0 0 0 1 0 3 0 1 -1"), "corner -1, which");
  const auto changed = [](std::string from, const std::string& to) {
    std::string file = triangle();
    return file.replace(file.find(from), from.size(), to);
  };
  expect_bad(changed("float y", "float v"), "without x, y and z");
  expect_bad(changed("float y", "float x"), "without x, y and z");
  expect_bad(changed("element face", "element faces"), "has no faces");
  expect_bad(changed("element face", "element tristrips"), "triangle strips");
  expect_bad(changed("element vertex 3", "element vertex 0\nproperty int i\nelement vertex 3"),
             "without x, y and z");
}

TEST(PlyReader, CountsThatPromiseTooMuchAllocateNothing) {
  for (const char* count : {"100000000000", "18446744073709551615"}) {
    for (const PlyEncoding encoding : kEncodings) {
      for (const std::string element : {"vertex", "face", "other"}) {
        SCOPED_TRACE(element + " " + count);
        const PlyBuilder ply(encoding, "element " + element + " " + count +
                                           "\nproperty float x\nproperty float y\n"
                                           "property list uint int vertex_indices\n");
        expect_bad(ply.file() + "0 0 0 ", "is cut short: it promises");
      }
    }
  }
  // One face that claims four billion corners.
  PlyBuilder face(PlyEncoding::kLittleEndian,
                  "element face 1\nproperty list uint uint vertex_indices\n");
  face.number(0xffffffffu).number(1u).number(2u);
  expect_bad(face.file(), "the file is cut short");
  // Entries of no size cost no time, however many.
  expect_bad("ply\nformat ascii 1.0\nelement face 18446744073709551615\nend_header\n",
             "has no faces");
  expect_error(ErrorCode::kOverLimit, "134 million", [&] {
    parse_ply("a.ply", "ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nend_header\n");
  });
}

TEST(PlyReader, AnyCutOrFlippedByteIsReadOrRefusedInOneSentence) {
  for (const PlyEncoding encoding : kEncodings) {
    const std::string whole = square(encoding);
    std::size_t refused = 0;
    const auto try_file = [&](const std::string& file) {
      try {
        const TriangleMesh mesh = parse_ply("a.ply", file);
        for (const Triangle& t : mesh.triangles)
          for (const std::uint32_t v : t.v) ASSERT_LT(v, mesh.vertices.size());
      } catch (const Error& error) {
        EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
        ++refused;
      }
    };
    for (std::size_t size = 0; size + 2 < whole.size(); ++size) try_file(whole.substr(0, size));
    EXPECT_EQ(refused, whole.size() - 2) << "every cut file lacks something";
    for (std::size_t at = 0; at < whole.size(); ++at)
      for (const char c : {'\0', '\n', ' ', '-', '9', 'f', '\x7f', '\x80', '\xff'}) {
        std::string file = whole;
        file[at] = c;
        try_file(file);
      }
  }
}

TEST(PlyReader, AFileThatIsNotThereIsAnIoError) {
  const TempFolder folder;
  expect_error(ErrorCode::kIo, "none.ply",
               [&] { read_mesh(folder.file("none.ply"), ObjContent::kShape); });
}

}  // namespace
}  // namespace mdk::test
