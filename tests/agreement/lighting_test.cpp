// Lit pictures: the same with every technique, thread count and instruction set; light and shadow
// where geometry says, at any scale.
#include "common/trace/lighting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "common/base/isa.h"
#include "common/base/parallel.h"
#include "common/trace/renderer.h"
#include "tests/agreement/test_scenes.h"

namespace mdk {
namespace {

using test::bake;
using test::ResetIsa;

std::vector<std::uint32_t> picture(Renderer& renderer, const FrameRequest& request) {
  renderer.render(request);
  return {renderer.pixels().begin(), renderer.pixels().end()};
}

TEST(LitPictures, AreTheSameWithEveryTechniqueThreadCountAndInstructionSet) {
  const ResetIsa reset;
  const DecomposeResult baked = bake(test::flying_boxes(30, 6));
  const ModelView model = baked.model.view();
  FrameRequest request{.at = locate_time(model, 0, 0.07),
                       .camera = fit_camera(model.bounds, 1.0),
                       .width = 75,
                       .height = 61,
                       .shading = ShadingMode::kLit};
  Renderer renderer(model, "brute-force");
  const std::vector<std::uint32_t> expected = picture(renderer, request);
  for (const std::string_view isa : available_isas())
    for (const TechniqueInfo& row : technique_table()) {
      if (row.kind == TechniqueKind::kPeer) continue;
      limit_isa(isa);
      const ThreadLimit limit(row.id.size() % 2 == 0 ? 1 : 2);
      renderer.set_technique(row.id);
      EXPECT_TRUE(picture(renderer, request) == expected) << row.id << ", " << isa;
    }
}

/// Quads, two triangles each, white.
class Quads {
 public:
  void add(const Vec3f& corner, const Vec3f& u, const Vec3f& v) {
    const auto first = static_cast<std::uint32_t>(sequence_.positions.size());
    for (const Vec3f& p : {corner, corner + u, corner + u + v, corner + v})
      sequence_.positions.push_back(p);
    sequence_.triangles.push_back({{first, first + 1, first + 2}});
    sequence_.triangles.push_back({{first, first + 2, first + 3}});
  }
  PoseSequence scaled(float scale, const Vec3f& offset) const {
    PoseSequence s = sequence_;
    for (Vec3f& p : s.positions) p = p * scale + offset;
    s.vertex_count = static_cast<std::uint32_t>(s.positions.size());
    s.clips = {{"still", 0, 1}};
    s.key_times = {0};
    s.appearance.materials = {Material{.flags = kMaterialFlatShaded}};
    s.appearance.triangle_materials.assign(s.triangles.size(), 0);
    return s;
  }

 private:
  PoseSequence sequence_;
};

/// Light in a picture of a still model, pixel by pixel.
class LitView {
 public:
  LitView(PoseSequence sequence, const Camera& camera, std::uint32_t occlusion_rays)
      : baked_(bake(std::move(sequence))), model_(baked_.model.view()) {
    Renderer renderer(model_, "fuzzy-bvh");
    renderer.trace({.at = at_key(0), .camera = camera, .width = kSide, .height = kSide});
    const HitBuffer& hits = renderer.hits();
    PosedMesh mesh(model_);
    mesh.set_time(at_key(0));
    const auto technique = find_technique("fuzzy-bvh").make(model_);
    technique->prebuild(mesh);
    technique->update(mesh);
    technique->prepare_occlusion();
    const PinholeRays rays = make_pinhole_rays(camera, kSide, kSide);
    Lighting lighting(*technique, rays, model_.bounds);
    lighting.choose_directions(occlusion_rays, 0);

    std::vector<SurfaceVertex> vertices(model_.vertex_count);
    for (std::size_t v = 0; v < vertices.size(); ++v) vertices[v].position = mesh.positions()[v];
    const std::vector<Vec3f> white{{1, 1, 1}};
    const std::vector<std::uint8_t> flat(model_.triangle_count(), 1);
    const std::vector<std::uint32_t> paint(model_.triangle_count(), 0);
    const ShadedMesh shaded{
        model_.triangles.data(), vertices.data(), flat.data(), white.data(), paint.data(), nullptr};
    const auto scratch = std::make_unique<Lighting::Scratch>();
    for (std::size_t i = 0; i < hits.tile_count(); ++i) {
      SurfaceTile surface{};
      LightTile light;
      if (!hits.is_hit(i)) continue;
      compute_surface(rays, hits.tile_left(i), hits.tile_top(i), shaded, hits.tile(i),
                      {.normals = true, .barycentrics = true}, surface);
      rays_ += lighting.light_tile({shaded, hits.tile(i), surface, kTileSide, kTileSide}, *scratch,
                                   light);
      for (std::uint32_t p = 0; p < kTilePixels; ++p)
        if (hits.tile(i).triangle[p] != kNoHit)
          pixels_.push_back(light.red[p] + light.green[p] + light.blue[p]);
    }
  }

  const std::vector<float>& pixels() const { return pixels_; }  ///< that hit something
  std::uint64_t rays() const { return rays_; }
  float mean() const {
    double sum = 0;
    for (const float p : pixels_) sum += static_cast<double>(p);
    return static_cast<float>(sum / static_cast<double>(pixels_.size()));
  }
  float min() const { return *std::min_element(pixels_.begin(), pixels_.end()); }
  float max() const { return *std::max_element(pixels_.begin(), pixels_.end()); }

 private:
  static constexpr std::uint32_t kSide = 64;
  DecomposeResult baked_;
  ModelView model_;
  std::vector<float> pixels_;
  std::uint64_t rays_ = 0;
};

/// Looks straight at z = 0 around `at`; the picture shows `size` of it.
Camera straight_at(const Vec3f& at, float size, float scale, const Vec3f& offset) {
  const float distance = size / (2 * std::tan(0.05f));
  const auto place = [&](const Vec3f& p) { return p * scale + offset; };
  return {.eye = place(at + Vec3f{0, 0, distance}),
          .target = place(at),
          .up = {0, 1, 0},
          .vertical_fov_deg = static_cast<float>(0.1 * 180 / std::numbers::pi)};
}

struct Place {
  float scale;
  Vec3f offset;
};
/// Coordinates of these round to 2^-24 of what they are: far away, the geometry itself is coarse.
const Place kPlaces[] = {
    {1, {}},     {1e-6f, {}}, {1e6f, {}}, {1, {3e3f, -5e3f, 1e3f}}, {1024, {1e6f, 1e6f, -1e6f}},
    {1e-12f, {}}};

TEST(Lighting, AnOpenPlaneIsLitInFullAtAnyScale) {
  for (const auto& [scale, offset] : kPlaces) {
    Quads plane;
    for (int x = -8; x < 8; ++x)  // many triangles, whose neighbours must not shade each other
      for (int y = -8; y < 8; ++y)
        plane.add({static_cast<float>(x), static_cast<float>(y), 0}, {1, 0, 0}, {0, 1, 0});
    const LitView view(plane.scaled(scale, offset), straight_at({}, 12, scale, offset), 16);
    ASSERT_EQ(view.pixels().size(), 64u * 64);
    EXPECT_EQ(view.rays(), 64u * 64 * 17) << "16 to the sky and one to the key light";
    EXPECT_GT(view.min(), 0.93f * view.max()) << scale << ", " << offset.x;
  }
}

TEST(Lighting, CurvedAndFoldedSurfacesHaveNoAcneAtAnyScale) {
  // A saw-tooth of long thin facets seen along its ridges' light: convex folds shade nothing.
  for (const auto& [scale, offset] : kPlaces) {
    Quads arch;
    constexpr int kFacets = 64;
    for (int i = 0; i < kFacets; ++i) {
      const auto at = [&](int k) {
        const double angle = std::numbers::pi * (0.1 + 0.8 * k / kFacets);
        return Vec3f{static_cast<float>(-8 * std::cos(angle)), -8,
                     static_cast<float>(8 * std::sin(angle))};
      };
      arch.add(at(i), at(i + 1) - at(i), {0, 16, 0});
    }
    const Camera camera = straight_at({0, 0, 8}, 10, scale, offset);
    const LitView lit(arch.scaled(scale, offset), camera, 16),
        open(arch.scaled(scale, offset), camera, 0);
    ASSERT_EQ(lit.pixels().size(), open.pixels().size());
    // Sky through 16 directions is not quite its mean over all, but nothing may be shaded.
    for (std::size_t i = 0; i < lit.pixels().size(); ++i)
      ASSERT_NEAR(lit.pixels()[i], open.pixels()[i], 0.25f) << scale << ", pixel " << i;
  }
}

TEST(Lighting, ATallWallHidesHalfOfTheSkyAtItsFoot) {
  for (const auto& [scale, offset] : kPlaces) {
    Quads floor, corner;
    floor.add({-1000, -1000, 0}, {2000, 0, 0}, {0, 2000, 0});
    corner.add({-1000, -1000, 0}, {2000, 0, 0}, {0, 2000, 0});
    corner.add({-0.25f, -1000, 0}, {0, 2000, 0}, {0, 0, 1000});
    const Camera camera = straight_at({}, 0.25f, scale, offset);
    if (scale == 1024) continue;  // a step of coordinates is as large as the view
    const LitView open(floor.scaled(scale, offset), camera, 64),
        beside(corner.scaled(scale, offset), camera, 64);
    // The wall stands left, where the key light comes from too: only sky is left, half of it.
    EXPECT_LT(beside.mean(), open.mean());
    const LitView dark(corner.scaled(scale, offset), camera, 0);
    EXPECT_NEAR(beside.mean() / dark.mean(), 0.5f, 0.06f) << scale << ", " << offset.x;
  }
}

TEST(Lighting, ARoofCastsItsShadowWhereTheKeyLightSays) {
  // The key light comes from (-0.55, 0.75, 0.65): a roof at height h darkens what lies h/0.65 times
  // (0.55, -0.75) from below it.
  constexpr float kHeight = 0.1f;
  for (const auto& [scale, offset] : kPlaces) {
    if (scale == 1024) continue;
    Quads scene;
    scene.add({-50, -50, 0}, {100, 0, 0}, {0, 100, 0});
    scene.add({-0.5f, -0.5f, kHeight}, {1, 0, 0}, {0, 1, 0});
    const auto light_at = [&](const Vec3f& p) {
      // Seen from the side of the light and the eye, under the roof: a camera below it.
      Camera camera;
      camera.eye = (p + Vec3f{0, 0, 0.02f}) * scale + offset;
      camera.target = p * scale + offset;
      camera.vertical_fov_deg = 5;
      return LitView(scene.scaled(scale, offset), camera, 0).mean();
    };
    const Vec3f shift = Vec3f{0.55f, -0.75f, 0} * (kHeight / 0.65f);
    const float bright = light_at({3, 3, 0});
    const float dark = light_at(shift);
    EXPECT_GT(bright, 1.8f * dark);
    const auto is_dark = [&](const Vec3f& p) { return light_at(p + shift) < 1.1f * dark; };
    const auto is_bright = [&](const Vec3f& p) { return light_at(p + shift) > 0.9f * bright; };
    for (const float side : {-1.0f, 1.0f}) {
      EXPECT_TRUE(is_dark({side * 0.49f, 0.1f, 0})) << scale;
      EXPECT_TRUE(is_dark({0.1f, side * 0.49f, 0})) << scale;
      EXPECT_TRUE(is_bright({side * 0.51f, 0.1f, 0})) << scale;
      EXPECT_TRUE(is_bright({0.1f, side * 0.51f, 0})) << scale;
    }
  }
}

}  // namespace
}  // namespace mdk
