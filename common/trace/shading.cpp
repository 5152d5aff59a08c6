#include "common/trace/shading.h"

#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <cmath>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/trace/color.h"
#include "common/trace/texture_sampling.h"

namespace mdk {
namespace {

constexpr float kAmbient = 0.12f;
constexpr float kAmbientOfHeat = 0.7f;  ///< shape shows, colours stay those of the scale
constexpr float kUnhitWork = 0.45f;     ///< how bright work is where nothing was hit

}  // namespace

std::span<const ShadingInfo> shading_table() {
  static constexpr ShadingInfo kTable[] = {
      {ShadingMode::kDiffuse, "diffuse", "Diffuse"},
      {ShadingMode::kNormals, "normals", "Normals"},
      {ShadingMode::kLit, "lit", "Lit"},
      {ShadingMode::kClusters, "clusters", "Clusters"},
      {ShadingMode::kBoxes, "boxes", "Boxes"},
      {ShadingMode::kTests, "tests", "Tests"},
      {ShadingMode::kResidual, "residual", "Residual"},
  };
  return kTable;
}

ShadingMode find_shading(std::string_view id) {
  std::string known;
  for (const ShadingInfo& row : shading_table()) {
    if (row.id == id) return row.mode;
    known.append(known.empty() ? "" : ", ").append(row.id);
  }
  throw Error(ErrorCode::kUsage,
              "no shading mode is called '" + std::string(id) + "'; there are " + known);
}

Vec3f cluster_color(std::uint32_t cluster) {
  // Hues a golden ratio apart never come close to an earlier one.
  const double turn = std::fmod(0.58 + cluster * 0.6180339887498949, 1.0);
  const auto channel = [turn](double offset) {
    const double k = std::fmod(offset + turn * 6, 6.0);
    const double value = 1 - 0.62 * std::max(0.0, std::min({k, 4 - k, 1.0}));
    return static_cast<float>(value * value * 0.9);
  };
  return {channel(5), channel(3), channel(1)};
}

/// One tile on its way from hits to the film.
struct Shader::Tile {
  const TileHits* hits;
  bool is_hit;
  std::size_t number;
  std::uint32_t left, top;      ///< in the image
  std::uint32_t columns, rows;  ///< inside the image
  SurfaceTile& surface;
  bool shows_misses = false;  ///< misses have a colour of their own on the surface

  Tile(const HitBuffer& image, std::size_t i, SurfaceTile& place)
      : hits(&image.tile(i)),
        is_hit(image.is_hit(i)),
        number(i),
        left(image.tile_left(i)),
        top(image.tile_top(i)),
        columns(std::min(kTileSide, image.width() - left)),
        rows(std::min(kTileSide, image.height() - top)),
        surface(place) {}
};

/// What a thread keeps between tiles.
struct Shader::Scratch {
  SurfaceTile surface{};
  Lighting::Scratch lighting;
};

Shader::Shader(const Model& model)
    : model_(&model),
      triangle_cluster_(model.triangle_count()),
      is_flat_(model.triangle_count()),
      vertices_(model) {
  for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
    const Cluster& cluster = model.clusters[c];
    std::fill_n(triangle_cluster_.begin() + cluster.first_triangle, cluster.triangle_count, c);
    cluster_colors_.push_back(cluster_color(c));
  }
  for (const Material& material : model.appearance.materials) {
    const float* color = material.base_color;
    material_colors_.push_back({color[0], color[1], color[2]});
    is_unlit_material_.push_back((material.flags & kMaterialUnlit) != 0);
    has_unlit_ = has_unlit_ || is_unlit_material_.back() != 0;
    has_textures_ = has_textures_ || material.texture != kNoTexture;
  }
  has_textures_ = has_textures_ && !model.appearance.corner_texcoords.empty();
  for (std::size_t t = 0; t < is_flat_.size(); ++t) {
    const Material& material = model.appearance.materials[model.appearance.triangle_materials[t]];
    is_flat_[t] = (material.flags & kMaterialFlatShaded) != 0;
  }
}

ShadedMesh Shader::shaded_mesh(ShadingMode mode) const {
  ShadedMesh shaded{};
  shaded.triangles = model_->triangles.data();
  shaded.vertices = vertices_.data();
  shaded.is_flat = is_flat_.data();
  if (mode == ShadingMode::kClusters) {
    shaded.palette = cluster_colors_.data();
    shaded.palette_index = triangle_cluster_.data();
  } else if (mode == ShadingMode::kResidual) {
    shaded.palette = heat_.palette().data();
    shaded.palette_index = heat_.triangle_colors().data();
  } else {
    shaded.palette = material_colors_.data();
    shaded.palette_index = model_->appearance.triangle_materials.data();
    if (!model_->appearance.corner_colors.empty())
      shaded.corner_colors = model_->appearance.corner_colors.data();
  }
  return shaded;
}

SurfaceWishes Shader::wishes(ShadingMode mode) const {
  const bool is_lit = mode == ShadingMode::kLit;
  const bool shows_paint = is_lit || mode == ShadingMode::kDiffuse;
  return {.facing = !is_lit && mode != ShadingMode::kNormals,
          .normals = is_lit || mode == ShadingMode::kNormals,
          .barycentrics = is_lit || (shows_paint && has_textures_)};
}

void Shader::apply_textures(Tile& tile) const {
  SurfaceTile& s = tile.surface;
  for (std::uint32_t i = 0; i < tile.rows * kTileSide; ++i) {
    const std::uint32_t triangle = tile.hits->triangle[i];
    if (triangle == kNoHit) continue;
    const Material& material =
        model_->appearance.materials[model_->appearance.triangle_materials[triangle]];
    if (material.texture == kNoTexture) continue;
    const float bary[3] = {1 - s.bary1[i] - s.bary2[i], s.bary1[i], s.bary2[i]};
    const auto* uv = &model_->appearance.corner_texcoords[std::size_t{3} * triangle];
    const TexCoord at{uv[0].u * bary[0] + uv[1].u * bary[1] + uv[2].u * bary[2],
                      uv[0].v * bary[0] + uv[1].v * bary[1] + uv[2].v * bary[2]};
    const Vec3f texel = sample_texture(model_->appearance.textures[material.texture],
                                       model_->appearance.texels, at, material);
    s.red[i] *= texel.x;
    s.green[i] *= texel.y;
    s.blue[i] *= texel.z;
  }
}

HeatScale Shader::prepare_heat(const ShadingInput& input, ShadingMode mode) {
  switch (mode) {
    case ShadingMode::kBoxes:
      return heat_.color_tiles(input.tile_work, &TraceCounters::node_visits, "visits per ray");
    case ShadingMode::kTests:
      return heat_.color_tiles(input.tile_work, &TraceCounters::triangle_tests, "tests per ray");
    case ShadingMode::kResidual:
      return heat_.color_triangles(input.mesh);
    default:
      return {};
  }
}

bool Shader::is_unlit(std::uint32_t triangle) const {
  return triangle != kNoHit &&
         is_unlit_material_[model_->appearance.triangle_materials[triangle]] != 0;
}

void Shader::show_normals(Tile& tile) const {
  SurfaceTile& s = tile.surface;
  for (std::uint32_t i = 0; i < tile.rows * kTileSide; ++i) {
    s.red[i] = s.normal_x[i] * 0.5f + 0.5f;
    s.green[i] = s.normal_y[i] * 0.5f + 0.5f;
    s.blue[i] = s.normal_z[i] * 0.5f + 0.5f;
  }
}

void Shader::show_work(Tile& tile) const {
  SurfaceTile& s = tile.surface;
  const Vec3f& color = heat_.tile_color(tile.number);
  for (std::uint32_t i = 0; i < kTilePixels; ++i) {
    const bool is_hit = tile.is_hit && tile.hits->triangle[i] != kNoHit;
    const float light = is_hit ? kAmbientOfHeat + (1 - kAmbientOfHeat) * s.facing[i] : kUnhitWork;
    s.red[i] = color.x * light;
    s.green[i] = color.y * light;
    s.blue[i] = color.z * light;
  }
  tile.shows_misses = true;
}

/// A headlight; `least` is what light is left where the surface is seen edge-on.
void Shader::light_from_eye(ShadingMode mode, float least, Tile& tile) const {
  SurfaceTile& s = tile.surface;
  alignas(64) float light[kTilePixels];
  const std::uint32_t pixels = tile.rows * kTileSide;
  for (std::uint32_t i = 0; i < pixels; ++i) light[i] = least + (1 - least) * s.facing[i];
  const bool some_plain = mode == ShadingMode::kDiffuse && has_unlit_;
  for (std::uint32_t i = 0; some_plain && i < pixels; ++i)
    if (is_unlit(tile.hits->triangle[i])) light[i] = 1;
  for (std::uint32_t i = 0; i < pixels; ++i) {
    s.red[i] *= light[i];
    s.green[i] *= light[i];
    s.blue[i] *= light[i];
  }
}

/// Returns how many rays were traced.
std::uint64_t Shader::light_from_lamps(const Lighting& lighting, const ShadedMesh& mesh,
                                       Lighting::Scratch& scratch, Tile& tile) const {
  if (has_textures_) apply_textures(tile);
  SurfaceTile& s = tile.surface;
  LightTile light;
  const std::uint64_t rays =
      lighting.light_tile({mesh, *tile.hits, s, tile.columns, tile.rows}, scratch, light);
  for (std::uint32_t i = 0; i < tile.rows * kTileSide; ++i) {
    if (has_unlit_ && is_unlit(tile.hits->triangle[i])) continue;
    s.red[i] *= light.red[i];
    s.green[i] *= light.green[i];
    s.blue[i] *= light.blue[i];
  }
  return rays;
}

/// Every mode but kLit.
void Shader::show_tile(ShadingMode mode, Tile& tile) const {
  switch (mode) {
    case ShadingMode::kNormals:
      return show_normals(tile);
    case ShadingMode::kBoxes:
    case ShadingMode::kTests:
      return show_work(tile);
    case ShadingMode::kResidual:
      return light_from_eye(mode, kAmbientOfHeat, tile);
    case ShadingMode::kDiffuse:
      if (has_textures_) apply_textures(tile);
      return light_from_eye(mode, kAmbient, tile);
    default:
      return light_from_eye(mode, kAmbient, tile);
  }
}

/// A tile that some ray hits, or that shows how much work it was. Returns how many rays were
/// traced.
std::uint64_t Shader::shade_tile(const ShadingInput& input, ShadingMode mode, Tile& tile,
                                 Scratch& scratch) const {
  const ShadedMesh mesh = shaded_mesh(mode);
  if (tile.is_hit)
    compute_surface(input.rays, tile.left, tile.top, mesh, *tile.hits, wishes(mode), tile.surface);
  if (mode == ShadingMode::kLit)
    return light_from_lamps(*input.lighting, mesh, scratch.lighting, tile);
  show_tile(mode, tile);
  return 0;
}

ShadingReport Shader::shade(const ShadingInput& input, ShadingMode mode, Film& film) {
  const HitBuffer& hits = input.hits;
  std::vector<std::uint32_t> hit_tiles;
  for (std::size_t i = 0; i < hits.tile_count(); ++i)
    if (hits.is_hit(i)) hit_tiles.push_back(static_cast<std::uint32_t>(i));
  vertices_.update(input.mesh, hits, hit_tiles);

  ShadingReport report{.heat = prepare_heat(input, mode)};
  tbb::enumerable_thread_specific<Scratch> scratches;
  std::atomic<std::uint64_t> rays = 0;
  parallel_chunks(hits.tile_count(), 8, [&](std::size_t begin, std::size_t end) {
    Scratch& scratch = scratches.local();
    std::uint64_t rays_here = 0;
    for (std::size_t i = begin; i < end; ++i) {
      Tile tile(hits, i, scratch.surface);
      if (!tile.is_hit && !shows_work(mode)) {
        film.put_background(tile.left, tile.top);
        continue;
      }
      rays_here += shade_tile(input, mode, tile, scratch);
      const SurfaceTile& s = tile.surface;
      film.put_tile(tile.left, tile.top,
                    {s.red, s.green, s.blue, tile.shows_misses ? nullptr : tile.hits->triangle});
    }
    rays.fetch_add(rays_here, std::memory_order_relaxed);
  });
  report.rays = rays;
  return report;
}

}  // namespace mdk
