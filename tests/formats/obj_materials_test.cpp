#include <gmock/gmock.h>

#include <cmath>

#include "common/base/error.h"
#include "formats/files/image_writer.h"
#include "formats/mesh/materials.h"
#include "formats/mesh/reader.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::FloatNear;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 1\nvt 1 1\nvt 1 0\nvt 0 0\n";
const std::string kRedFace = "usemtl red\nf 1/1 2/2 3/3\n";

class ObjMaterials : public testing::Test {
 protected:
  ReadResult read(const std::string& text) {
    const std::string path = folder_.file("mesh.obj");
    write_text(path, text);
    SilentProgress silent;
    return read_mesh_sequence(files_from(path), {}, silent);
  }
  void put(const std::string& name, const std::string& text) {
    write_text(folder_.file(name), text);
  }
  /// A picture of one texel of (200, 100, 50).
  void put_texel(const std::string& name) {
    const std::uint32_t texel[] = {0xff000000u | 50u << 16 | 100u << 8 | 200u};
    write_png(folder_.file(name), 1, 1, texel);
  }

  TempFolder folder_;
};

TEST_F(ObjMaterials, BaseColoursAreSrgbAndByFace) {
  put("a.mtl", "newmtl unused\nKd 0 0 0\nnewmtl dark red\nKd 0.5 0 2\nnewmtl grey\n Kd 0.02\n");
  const ReadResult result = read("mtllib a.mtl\n" + kSquare +
                                 "f 1 2 3\nusemtl dark red\nf 1 3 4\nusemtl grey\nf 2 3 4\n");
  const Appearance& appearance = result.sequence.appearance;
  ASSERT_EQ(appearance.materials.size(), 3u) << "those that faces use";
  EXPECT_THAT(appearance.triangle_materials, ElementsAre(0, 1, 2));
  EXPECT_EQ(appearance.materials[0], Material{});
  EXPECT_THAT(appearance.materials[1].base_color,
              ElementsAre(FloatNear(0.21404114f, 1e-6f), 0.0f, 1.0f, 1.0f));
  EXPECT_THAT(appearance.materials[2].base_color[2], FloatNear(0.02f / 12.92f, 1e-7f));
  EXPECT_THAT(appearance.corner_texcoords, IsEmpty()) << "nothing has a texture";
  EXPECT_THAT(result.notes, IsEmpty());
  EXPECT_THAT(result.dependencies, ElementsAre(EndsWith("mesh.obj"), EndsWith("a.mtl")));
}

TEST_F(ObjMaterials, ATextureStandsInPlaceOfTheColour) {
  std::filesystem::create_directory(folder_.file("images"));
  put_texel("images/one texel.png");
  put("a b.mtl", "newmtl red\nKd 0 0 0\nmap_Kd images\\one texel.png\n");
  const ReadResult result = read("mtllib a b.mtl\n" + kSquare + kRedFace);
  const Appearance& appearance = result.sequence.appearance;
  EXPECT_THAT(appearance.texels, ElementsAre(0xff000000u | 50u << 16 | 100u << 8 | 200u));
  EXPECT_EQ(appearance.materials[0].texture, 0u);
  EXPECT_THAT(appearance.materials[0].base_color, ElementsAre(1, 1, 1, 1));
  ASSERT_EQ(appearance.corner_texcoords.size(), 3u);
  EXPECT_EQ(appearance.corner_texcoords[0].v, 0.0f) << "1 in the file: the upper edge";
  EXPECT_EQ(appearance.corner_texcoords[2].v, 1.0f);
  EXPECT_THAT(result.dependencies, Contains(EndsWith("one texel.png")));
  EXPECT_THAT(result.notes, IsEmpty());
}

TEST_F(ObjMaterials, OptionsOfATextureAreNoted) {
  put_texel("t.png");
  put("a.mtl", "newmtl red\nmap_Kd -s 2 2 1 -clamp on -o 0.5 t.png\n");
  const ReadResult result = read("mtllib a.mtl\n" + kSquare + kRedFace);
  EXPECT_EQ(result.sequence.appearance.textures.size(), 1u);
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("the options of a map_Kd are left out")));
}

TEST_F(ObjMaterials, CornersOfATextureWithoutCoordinatesAreNoted) {
  put_texel("t.png");
  put("a.mtl", "newmtl red\nmap_Kd t.png\n");
  const std::string text = "mtllib a.mtl\n" + kSquare + "usemtl red\n";
  EXPECT_THAT(read(text + "f 1/1 2/2 3\n").notes,
              ElementsAre(HasSubstr("have no texture coordinates; (0, 0) is taken")));
  const ReadResult none = read("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl red\nf 1 2 3\n");
  EXPECT_THAT(none.notes, ElementsAre(HasSubstr("has a texture but not its coordinates")));
  EXPECT_THAT(none.sequence.appearance.textures, IsEmpty());
}

TEST_F(ObjMaterials, SeveralFilesMayDescribeThem) {
  put("a.mtl", "newmtl red\nKd 1 0 0\n");
  put("b.mtl", "newmtl red\nKd 0 1 0\nnewmtl blue\nKd 0 0 1\n");
  for (const char* libraries : {"mtllib a.mtl b.mtl\n", "mtllib a.mtl\nmtllib b.mtl\n"}) {
    const ReadResult result = read(libraries + kSquare + kRedFace + "usemtl blue\nf 1 3 4\n");
    const Appearance& appearance = result.sequence.appearance;
    EXPECT_THAT(appearance.materials[0].base_color, ElementsAre(1, 0, 0, 1)) << "the first counts";
    EXPECT_THAT(appearance.materials[1].base_color, ElementsAre(0, 0, 1, 1));
    EXPECT_THAT(result.notes, IsEmpty());
    EXPECT_EQ(result.dependencies.size(), 3u);
  }
}

TEST_F(ObjMaterials, WhatIsMissingIsANoteAndGrey) {
  const ReadResult without = read("mtllib none.mtl\n" + kSquare + kRedFace);
  EXPECT_THAT(without.notes, ElementsAre(HasSubstr("cannot be read beside it")));
  EXPECT_THAT(without.unread, ElementsAre(EndsWith("none.mtl")));
  EXPECT_EQ(without.sequence.appearance.materials[0], Material{});
  put("a.mtl", "newmtl blue\nKd 0 0 1\n");
  EXPECT_THAT(read("mtllib a.mtl\n" + kSquare + kRedFace).notes,
              ElementsAre(HasSubstr("\"red\", which no .mtl describes")));
  EXPECT_THAT(read(kSquare + "f 1 2 3\n").notes, IsEmpty()) << "nothing was named";
}

TEST_F(ObjMaterials, ABrokenNumberOrImageIsANoteAndPlainColour) {
  put("bad.png", "no picture");
  put("a.mtl",
      "newmtl red\nKd 1 x 0\nmap_Kd bad.png\nnewmtl nan\nKd nan 0 0\nnewmtl gone\nKd 1 0 0\n"
      "map_Kd gone.png\n");
  const ReadResult result =
      read("mtllib a.mtl\n" + kSquare + kRedFace + "usemtl nan\nf 1 2 3\nusemtl gone\nf 1 2 4\n");
  const Appearance& appearance = result.sequence.appearance;
  EXPECT_EQ(appearance.materials[0], Material{});
  EXPECT_EQ(appearance.materials[1], Material{});
  EXPECT_THAT(appearance.materials[2].base_color, ElementsAre(1, 0, 0, 1));
  EXPECT_THAT(result.notes,
              testing::IsSupersetOf({HasSubstr("line 2 has a colour that cannot be read"),
                                     HasSubstr("\"bad.png\" is neither PNG nor JPEG"),
                                     HasSubstr("\"gone.png\" cannot be read")}));
  EXPECT_THAT(result.unread, ElementsAre(EndsWith("gone.png")));
}

TEST_F(ObjMaterials, AFileBrokenInEveryLineIsOneNoteOfEachKind) {
  std::string text = "newmtl red\n";
  for (int i = 0; i < 1000; ++i) text += "Kd red\nmap_Kd -s 2 a.png\n";
  put("a.mtl", text);
  EXPECT_EQ(read("mtllib a.mtl\n" + kSquare + kRedFace).notes.size(), 3u) << "and no a.png";
}

TEST_F(ObjMaterials, AMeshOfManyUnknownMaterialsIsReadWithAHundredNotes) {
  put("a.mtl", "newmtl red\n");
  std::string text = "mtllib a.mtl\n" + kSquare;
  for (int i = 0; i < 20'000; ++i) text += "usemtl m" + std::to_string(i) + "\nf 1 2 3\n";
  const ReadResult result = read(text);
  EXPECT_EQ(result.notes.size(), 100u);
  EXPECT_EQ(result.sequence.appearance.materials.size(), 20'000u);
}

TEST_F(ObjMaterials, NothingOutsideTheFolderIsOpened) {
  const std::string inner = folder_.file("inner");
  std::filesystem::create_directory(inner);
  put("out.mtl", "newmtl red\nKd 1 0 0\n");
  put_texel("out.png");
  const std::string absolute = folder_.file("out.mtl");
  for (const std::string& library : {std::string("../out.mtl"), std::string("..\\out.mtl"),
                                     absolute, std::string("x/../../out.mtl"), std::string(".")}) {
    write_text(inner + "/in.obj", "mtllib " + library + "\n" + kSquare + kRedFace);
    SilentProgress silent;
    const ReadResult result = read_mesh_sequence(files_from(inner + "/in.obj"), {}, silent);
    EXPECT_EQ(result.sequence.appearance.materials[0], Material{}) << library;
    EXPECT_EQ(result.dependencies.size(), 1u) << library;
    EXPECT_THAT(result.notes, ElementsAre(HasSubstr("cannot be read beside it"))) << library;
  }
  write_text(inner + "/in.mtl", "newmtl red\nmap_Kd ../out.png\n");
  write_text(inner + "/in.obj", "mtllib in.mtl\n" + kSquare + kRedFace);
  SilentProgress silent;
  const ReadResult result = read_mesh_sequence(files_from(inner + "/in.obj"), {}, silent);
  EXPECT_THAT(result.sequence.appearance.textures, IsEmpty());
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("is not in the folder of its .mtl")));
}

TEST_F(ObjMaterials, AFileOfASequenceAfterTheFirstIsNotAskedForMaterials) {
  put("a.mtl", "newmtl red\nKd 1 0 0\n");
  put("s_1.obj", "mtllib a.mtl\n" + kSquare + kRedFace);
  put("s_2.obj", "mtllib none.mtl\n" + kSquare + kRedFace);
  SilentProgress silent;
  const ReadResult result =
      read_mesh_sequence(files_of_pattern(folder_.file("s_#.obj")), {}, silent);
  EXPECT_THAT(result.notes, IsEmpty());
  EXPECT_THAT(result.sequence.appearance.materials[0].base_color, ElementsAre(1, 0, 0, 1));
}

}  // namespace
}  // namespace mdk::test
