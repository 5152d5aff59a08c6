// Materials, textures and colours: what a corner looks like.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/formats/gltf_builder.h"
#include "tests/formats/gltf_expect.h"

namespace mdk::test {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// 2 x 2 texels: red, green / blue, (10, 20, 30, 40).
const char* const kPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAFUlEQVR42mP4z8DwHwyB9H8uETkNAECaBl+gm8JjAAAA"
    "AElFTkSuQmCC";
// The same with a header that says 10000 x 10000.
const char* const kHugePng =
    "iVBORw0KGgoAAAANSUhEUgAAJxAAACcQCAYAAAC6TmInAAAAFUlEQVR42mP4z8DwHwyB9H8uETkNAECaBl+gm8JjAA"
    "AAAElFTkSuQmCC";

/// A triangle with TEXCOORD_0 (0,0) (1,0) (0,1) and TEXCOORD_1 (0.5,0.5) everywhere.
class Textured {
 public:
  Textured() {
    attributes =
        "\"POSITION\": " + std::to_string(b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})) +
        ", \"TEXCOORD_0\": " + std::to_string(b.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1})) +
        ", \"TEXCOORD_1\": " +
        std::to_string(b.accessor<std::uint8_t>("VEC2", std::vector<std::uint8_t>(6, 51),
                                                ", \"normalized\": true"));
    b.add("nodes", "{\"mesh\": 0}");
    b.add("textures", "{\"source\": 0, \"sampler\": 0}");
    b.add("samplers", "{\"wrapS\": 33071, \"wrapT\": 33648}");
  }

  void image(const std::string& json) { b.add("images", json); }
  void embed(const std::string& png) { image("{\"uri\": \"data:image/png;base64," + png + "\"}"); }
  void material(const std::string& texture_info) {
    b.add("materials",
          "{\"pbrMetallicRoughness\": {\"baseColorFactor\": [0.5, 0.25, 2, 1], "
          "\"baseColorTexture\": {\"index\": 0" +
              texture_info + "}}}");
    b.mesh(attributes, ", \"material\": 0");
  }

  GltfBuilder b;
  std::string attributes;
};

/// Rounded, so that they can be compared as numbers written down.
std::vector<std::pair<float, float>> texcoords(const PoseSequence& s) {
  std::vector<std::pair<float, float>> all;
  for (const TexCoord& t : s.appearance.corner_texcoords)
    all.emplace_back(std::round(t.u * 1e5f) / 1e5f + 0.0f, std::round(t.v * 1e5f) / 1e5f + 0.0f);
  return all;
}

std::pair<float, float> uv(float u, float v) { return {u, v}; }

TEST(GltfAppearance, AFileWithoutMaterialsIsWhite) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + "}");
  const Appearance a = read_built(b).sequence.appearance;
  ASSERT_EQ(a.materials.size(), 1u);
  EXPECT_THAT(a.materials[0].base_color, Each(1.0f));
  EXPECT_EQ(a.materials[0].texture, kNoTexture);
  EXPECT_THAT(a.triangle_materials, ElementsAre(0));
  EXPECT_THAT(a.corner_texcoords, IsEmpty());
  EXPECT_THAT(a.corner_colors, IsEmpty());
}

TEST(GltfAppearance, DecodesTheBaseColourTextureRowByRow) {
  Textured t;
  t.embed(kPng);
  t.material("");
  const PoseSequence s = read_built(t.b).sequence;
  const Appearance& a = s.appearance;
  ASSERT_EQ(a.materials.size(), 1u);
  EXPECT_THAT(a.materials[0].base_color, ElementsAre(0.5f, 0.25f, 1.0f, 1.0f));
  EXPECT_EQ(a.materials[0].wrap_u, TextureWrap::kClamp);
  EXPECT_EQ(a.materials[0].wrap_v, TextureWrap::kMirror);
  ASSERT_EQ(a.materials[0].texture, 0u);
  EXPECT_EQ(a.textures[0].width, 2u);
  EXPECT_EQ(a.textures[0].height, 2u);
  EXPECT_THAT(a.texels, ElementsAre(0xff0000ffu, 0xff00ff00u, 0xffff0000u, 0x281e140au));
  EXPECT_THAT(texcoords(s), ElementsAre(uv(0, 0), uv(1, 0), uv(0, 1)));
}

TEST(GltfAppearance, ReadsImagesFromBufferViewsAndFromFiles) {
  Textured inside, beside;
  std::vector<std::uint8_t> png;
  for (const char* digits = kPng; png.size() < 78; digits += 4) {
    std::uint32_t group = 0;
    for (int k = 0; k < 4; ++k) {
      const std::string all = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
      group = group << 6 | static_cast<std::uint32_t>(all.find(digits[k]));
    }
    for (int shift : {16, 8, 0}) png.push_back(static_cast<std::uint8_t>(group >> shift));
  }
  inside.image(
      "{\"mimeType\": \"image/png\", \"bufferView\": " + std::to_string(inside.b.view(png)) + "}");
  inside.material("");
  EXPECT_EQ(read_built(inside.b).sequence.appearance.texels[3], 0x281e140au);

  beside.image("{\"uri\": \"maps/base%20colour.png\"}");
  beside.material("");
  const TempFolder folder;
  const std::string image =
      write_text(folder, "maps/base colour.png", std::string(png.begin(), png.end()));
  const std::string path = write_text(folder, "a.gltf", beside.b.json());
  const ReadResult r = read_file(path);
  EXPECT_EQ(r.sequence.appearance.texels[3], 0x281e140au);
  EXPECT_THAT(r.dependencies, ElementsAre(path, image));
}

TEST(GltfAppearance, TheTextureInfoChoosesTheCoordinateSet) {
  Textured t;
  t.embed(kPng);
  t.material(", \"texCoord\": 1");
  EXPECT_THAT(texcoords(read_built(t.b).sequence), Each(uv(0.2f, 0.2f)));
}

TEST(GltfAppearance, TextureTransformScalesThenTurnsThenShifts) {
  Textured t;
  t.embed(kPng);
  // A quarter turn takes (u, v) to (v, -u).
  t.material(
      ", \"extensions\": {\"KHR_texture_transform\": {\"offset\": [0.125, 1], \"scale\": "
      "[0.5, 0.25], \"rotation\": " +
      std::to_string(std::numbers::pi / 2) + "}}");
  EXPECT_THAT(texcoords(read_built(t.b).sequence),
              ElementsAre(uv(0.125f, 1), uv(0.125f, 0.5f), uv(0.375f, 1)));
}

TEST(GltfAppearance, TextureTransformMayChooseAnotherCoordinateSet) {
  Textured t;
  t.embed(kPng);
  t.material(
      ", \"extensions\": {\"KHR_texture_transform\": {\"texCoord\": 1, \"scale\": [5, 10]}}");
  EXPECT_THAT(texcoords(read_built(t.b).sequence), Each(uv(1, 2)));
}

TEST(GltfAppearance, AnImageThatCannotBeReadIsANoteAndPlainColour) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"{\"uri\": \"missing.png\"}", "cannot be read"},
      {"{\"uri\": \"../outside.png\"}", "cannot be read"},
      {"{\"uri\": \"http://example.org/a.png\"}", "cannot be read"},
      {"{\"uri\": \"data:image/png;base64,AAAAAAAA\"}", "neither PNG nor JPEG"},
      {"{\"uri\": \"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAA\"}", "cannot be decoded"},
      {"{\"uri\": \"data:image/png;base64," + std::string(kHugePng) + "\"}", "megapixels"},
  };
  for (const auto& [image, note] : cases) {
    SCOPED_TRACE(image.substr(0, 60));
    Textured t;
    t.image(image);
    t.material("");
    const ReadResult r = read_built(t.b);
    EXPECT_THAT(r.notes, ElementsAre(HasSubstr(note)));
    EXPECT_EQ(r.sequence.appearance.materials[0].texture, kNoTexture);
    EXPECT_THAT(r.sequence.appearance.texels, IsEmpty());
  }
}

TEST(GltfAppearance, ATextureWithoutItsCoordinatesIsANote) {
  Textured t;
  t.embed(kPng);
  t.material(", \"texCoord\": 2");
  const ReadResult r = read_built(t.b);
  EXPECT_THAT(r.notes, ElementsAre(HasSubstr("coordinates")));
  EXPECT_EQ(r.sequence.appearance.materials[0].texture, kNoTexture);
}

TEST(GltfAppearance, UnlitMaterialsAreMarked) {
  GltfBuilder b;
  b.add("materials", "{\"extensions\": {\"KHR_materials_unlit\": {}}}");
  b.triangle_mesh();
  b.at("meshes", 0).insert(b.at("meshes", 0).rfind("}]}"), ", \"material\": 0");
  b.add("nodes", "{\"mesh\": 0}");
  EXPECT_EQ(read_built(b).sequence.appearance.materials[0].flags,
            kMaterialUnlit | kMaterialFlatShaded);
}

TEST(GltfAppearance, ReadsVertexColoursOfEveryKind) {
  GltfBuilder b;
  const std::string positions =
      "\"POSITION\": " + std::to_string(b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}));
  const auto colored = [&](int colors) {
    const int mesh = b.mesh(positions + ", \"COLOR_0\": " + std::to_string(colors));
    b.add("nodes", "{\"mesh\": " + std::to_string(mesh) + "}");
  };
  colored(b.accessor<float>("VEC3", {1, 0, 0, 0, 1, 0, 0.5f, 7, -7}));
  colored(b.accessor<std::uint16_t>("VEC4", {65535, 0, 0, 0, 0, 0, 0, 32768, 0, 0, 0, 0},
                                    ", \"normalized\": true"));
  b.add("nodes", "{\"mesh\": " + std::to_string(b.mesh(positions)) + "}");
  EXPECT_THAT(read_built(b).sequence.appearance.corner_colors,
              ElementsAre(0xff0000ffu, 0xff00ff00u, 0xff00ff80u, 0x000000ffu, 0x80000000u, 0u,
                          0xffffffffu, 0xffffffffu, 0xffffffffu));
}

TEST(GltfAppearance, CornersFollowTheirTriangleWhenAMirrorTurnsIt) {
  Textured t;
  t.embed(kPng);
  t.material("");
  t.b.at("nodes", 0) = "{\"mesh\": 0, \"scale\": [-1, 1, 1]}";
  const PoseSequence s = read_built(t.b).sequence;
  EXPECT_THAT(texcoords(s), ElementsAre(uv(0, 0), uv(0, 1), uv(1, 0)));
  expect_pose(s, 0, {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}});
}

TEST(GltfAppearance, PrimitivesKeepTheirOwnMaterials) {
  GltfBuilder b;
  b.add("materials", "{\"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 0, 0, 1]}}");
  b.add("materials", "{\"pbrMetallicRoughness\": {\"baseColorFactor\": [0, 1, 0, 1]}}");
  const std::string positions =
      "{\"attributes\": {\"POSITION\": " +
      std::to_string(b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})) + "}, \"material\": ";
  b.add("meshes",
        "{\"primitives\": [" + positions + "1}, " + positions + "0}, " + positions + "1}]}");
  b.add("nodes", "{\"mesh\": 0}");
  const Appearance a = read_built(b).sequence.appearance;
  EXPECT_THAT(a.triangle_materials, ElementsAre(0, 1, 0));
  EXPECT_THAT(a.materials[0].base_color, ElementsAre(0, 1, 0, 1));
  EXPECT_THAT(a.materials[1].base_color, ElementsAre(1, 0, 0, 1));
}

}  // namespace
}  // namespace mdk::test
