#include "common/trace/shading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "common/base/error.h"
#include "common/trace/color.h"
#include "common/trace/renderer.h"

namespace mdk {
namespace {

TEST(Color, EverySrgbByteSurvivesTheWayThroughLinearLight) {
  for (std::uint32_t byte = 0; byte < 256; ++byte)
    EXPECT_NEAR(srgb_from_linear(linear_from_srgb(byte)), byte, byte < 12 ? 1 : 0.5) << byte;
  EXPECT_EQ(srgb_from_linear(-1), 0u);
  EXPECT_EQ(srgb_from_linear(7), 255u);
  EXPECT_EQ(srgb_from_linear(std::numeric_limits<float>::quiet_NaN()), 0u);
}

TEST(TextureSampling, TexelCentresGiveTheTexelAndBetweenThemItBlends) {
  const std::vector<std::uint32_t> texels = {0xff0000ff, 0xff00ff00, 0xffff0000, 0xffffffff};
  const Texture texture{2, 2, 0};
  const Material clamp{.wrap_u = TextureWrap::kClamp, .wrap_v = TextureWrap::kClamp};
  EXPECT_EQ(sample_texture(texture, texels, {0.25f, 0.25f}, clamp), (Vec3f{1, 0, 0}));
  EXPECT_EQ(sample_texture(texture, texels, {0.75f, 0.25f}, clamp), (Vec3f{0, 1, 0}));
  EXPECT_EQ(sample_texture(texture, texels, {0.25f, 0.75f}, clamp), (Vec3f{0, 0, 1}));
  EXPECT_EQ(sample_texture(texture, texels, {0.5f, 0.25f}, clamp), (Vec3f{0.5f, 0.5f, 0}));
}

TEST(TextureSampling, WrapModesRepeatClampAndMirror) {
  const std::vector<std::uint32_t> texels = {0xff000000, 0xffffffff};
  const Texture texture{2, 1, 0};
  const auto red_at = [&](float u, TextureWrap wrap) {
    return sample_texture(texture, texels, {u, 0.5f}, Material{.wrap_u = wrap}).x;
  };
  EXPECT_EQ(red_at(1.75f, TextureWrap::kRepeat), 1);
  EXPECT_EQ(red_at(-0.75f, TextureWrap::kRepeat), 0);
  EXPECT_EQ(red_at(5.0f, TextureWrap::kClamp), 1);
  EXPECT_EQ(red_at(-5.0f, TextureWrap::kClamp), 0);
  EXPECT_EQ(red_at(1.25f, TextureWrap::kMirror), 1);
  EXPECT_EQ(red_at(1.75f, TextureWrap::kMirror), 0);
}

TEST(TextureSampling, CoordinatesFarOutOrNotNumbersStayInsideTheImage) {
  const std::vector<std::uint32_t> texels = {1, 2, 3, 4, 5, 6};
  const Texture texture{3, 2, 0};
  const float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {inf, -inf, std::nanf(""), 1e30f, -1e30f})
    for (const TextureWrap wrap : {TextureWrap::kRepeat, TextureWrap::kClamp, TextureWrap::kMirror})
      sample_texture(texture, texels, {bad, bad}, {.wrap_u = wrap, .wrap_v = wrap});
}

TEST(ClusterColor, NeighboursAreEasilyToldApart) {
  for (std::uint32_t c = 0; c < 64; ++c) {
    const Vec3f a = cluster_color(c), b = cluster_color(c + 1);
    EXPECT_GT(std::abs(a.x - b.x) + std::abs(a.y - b.y) + std::abs(a.z - b.z), 0.3f) << c;
    for (const float channel : {a.x, a.y, a.z}) {
      EXPECT_GE(channel, 0);
      EXPECT_LE(channel, 1);
    }
  }
}

TEST(ShadingTable, KnowsItsIdsAndNamesThemWhenAskedForAnother) {
  for (const ShadingInfo& row : shading_table()) EXPECT_EQ(find_shading(row.id), row.mode);
  try {
    find_shading("shiny");
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::kUsage);
    EXPECT_NE(std::string(e.what()).find("diffuse"), std::string::npos);
  }
}

/// A square facing +z made of two triangles, each with a colour of its own.
ModelStorage colored_square() {
  ModelStorage m;
  m.vertex_count = 4;
  m.clips = {{"still", 0, 1}};
  m.key_times = {0};
  m.poses.key_positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  for (const Vec3f& p : m.poses.key_positions) m.bounds.extend(p);
  m.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
  m.source_triangles = {0, 1};
  m.clusters.resize(1);
  m.clusters[0].triangle_count = 2;
  m.key_boxes = {m.bounds};
  m.cluster_world_boxes = {quantize_outward(m.bounds, m.bounds)};
  m.local_from_world.resize(1);
  m.appearance.materials = {Material{.base_color = {1, 0, 0, 1}, .flags = kMaterialUnlit},
                            Material{.base_color = {0, 1, 0, 1}}};
  m.appearance.triangle_materials = {0, 1};
  return m;
}

TEST(Shader, ShowsBaseColoursUnlitAsTheyAreAndLitFacingTheEyeInFull) {
  const ModelStorage storage = colored_square();
  const ModelView model = storage.view();
  Renderer renderer(model, "brute-force");
  const Camera camera{.eye = {0, 0, 100}, .target = {0, 0, 0}, .vertical_fov_deg = 1.5f};
  renderer.render({.at = at_key(0), .camera = camera, .width = 64, .height = 64});
  EXPECT_EQ(renderer.pixels()[36 * 64 + 40], 0xff0000ffu);  // lower right: unlit red
  EXPECT_EQ(renderer.pixels()[28 * 64 + 24], 0xff00ff00u);  // upper left: green, facing the light
  const std::uint32_t above = renderer.pixels()[0];
  EXPECT_NE(above, 0xff0000ffu);
  EXPECT_NE(above, 0xff00ff00u);
}

TEST(Shader, SeesBothSidesAlike) {
  const ModelStorage storage = colored_square();
  const ModelView model = storage.view();
  Renderer renderer(model, "brute-force");
  const Camera back{.eye = {0, 0, -100}, .target = {0, 0, 0}, .vertical_fov_deg = 1.5f};
  renderer.render({.at = at_key(0), .camera = back, .width = 64, .height = 64});
  EXPECT_EQ(renderer.pixels()[28 * 64 + 40], 0xff00ff00u);
}

}  // namespace
}  // namespace mdk
