#include "common/trace/shading.h"

#include <cmath>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/trace/color.h"
#include "common/trace/texture_sampling.h"

namespace mdk {
namespace {

constexpr Vec3f kBackgroundTop{0.060f, 0.068f, 0.082f};
constexpr Vec3f kBackgroundBottom{0.016f, 0.018f, 0.022f};
constexpr float kAmbient = 0.12f;

/// One colour per row of the picture, darker downwards.
std::vector<std::uint32_t> background_rows(std::uint32_t height) {
  std::vector<std::uint32_t> rows(height);
  for (std::uint32_t y = 0; y < height; ++y) {
    const float down = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
    rows[y] = pack_srgb(kBackgroundTop * (1 - down) + kBackgroundBottom * down);
  }
  return rows;
}

}  // namespace

std::span<const ShadingInfo> shading_table() {
  static constexpr ShadingInfo kTable[] = {
      {ShadingMode::kDiffuse, "diffuse", "Diffuse"},
      {ShadingMode::kNormals, "normals", "Normals"},
      {ShadingMode::kClusters, "clusters", "Clusters"},
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

/// One tile on its way from hits to pixels.
struct Shader::Tile {
  const TileHits* hits = nullptr;
  std::uint32_t left = 0, top = 0;      ///< in the image
  std::uint32_t columns = 0, rows = 0;  ///< inside the image
  std::uint32_t image_width = 0;
  SurfaceTile surface{};
  alignas(64) float light[kTilePixels] = {};  ///< what part of the colour is seen

  Tile(const HitBuffer& image, std::size_t i)
      : hits(&image.tile(i)),
        left(image.tile_left(i)),
        top(image.tile_top(i)),
        columns(std::min(kTileSide, image.width() - left)),
        rows(std::min(kTileSide, image.height() - top)),
        image_width(image.width()) {}
};

Shader::Shader(const Model& model)
    : model_(&model),
      triangle_cluster_(model.triangle_count()),
      is_flat_(model.triangle_count()),
      vertex_normals_(model) {
  for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
    const Cluster& cluster = model.clusters[c];
    std::fill_n(triangle_cluster_.begin() + cluster.first_triangle, cluster.triangle_count, c);
    cluster_colors_.push_back(cluster_color(c));
  }
  for (const Material& material : model.materials) {
    const float* color = material.base_color;
    material_colors_.push_back({color[0], color[1], color[2]});
    is_unlit_.push_back((material.flags & kMaterialUnlit) != 0);
    has_unlit_ = has_unlit_ || is_unlit_.back() != 0;
    has_textures_ = has_textures_ || material.texture != kNoTexture;
  }
  has_textures_ = has_textures_ && !model.corner_texcoords.empty();
  for (std::size_t t = 0; t < is_flat_.size(); ++t) {
    const Material& material = model.materials[model.triangle_materials[t]];
    is_flat_[t] = (material.flags & kMaterialFlatShaded) != 0;
  }
}

ShadedMesh Shader::shaded_mesh(const PosedMesh& mesh, ShadingMode mode) const {
  ShadedMesh shaded{};
  shaded.triangles = model_->triangles.data();
  shaded.positions = mesh.positions().data();
  shaded.vertex_normals = vertex_normals_.data();
  shaded.is_flat = is_flat_.data();
  if (mode == ShadingMode::kClusters) {
    shaded.palette = cluster_colors_.data();
    shaded.palette_index = triangle_cluster_.data();
  } else {
    shaded.palette = material_colors_.data();
    shaded.palette_index = model_->triangle_materials.data();
    if (!model_->corner_colors.empty()) shaded.corner_colors = model_->corner_colors.data();
  }
  return shaded;
}

void Shader::apply_textures(Tile& tile) const {
  SurfaceTile& s = tile.surface;
  for (std::uint32_t i = 0; i < tile.rows * kTileSide; ++i) {
    const std::uint32_t triangle = tile.hits->triangle[i];
    if (triangle == kNoHit) continue;
    const Material& material = model_->materials[model_->triangle_materials[triangle]];
    if (material.texture == kNoTexture) continue;
    const float bary[3] = {1 - s.bary1[i] - s.bary2[i], s.bary1[i], s.bary2[i]};
    const auto* uv = &model_->corner_texcoords[std::size_t{3} * triangle];
    const TexCoord at{uv[0].u * bary[0] + uv[1].u * bary[1] + uv[2].u * bary[2],
                      uv[0].v * bary[0] + uv[1].v * bary[1] + uv[2].v * bary[2]};
    const Vec3f texel =
        sample_texture(model_->textures[material.texture], model_->texels, at, material);
    s.red[i] *= texel.x;
    s.green[i] *= texel.y;
    s.blue[i] *= texel.z;
  }
}

void Shader::light_tile(ShadingMode mode, Tile& tile) const {
  SurfaceTile& s = tile.surface;
  const std::uint32_t pixels = tile.rows * kTileSide;
  for (std::uint32_t i = 0; i < pixels; ++i)
    tile.light[i] = kAmbient + (1 - kAmbient) * s.facing[i];
  if (mode == ShadingMode::kNormals) {
    for (std::uint32_t i = 0; i < pixels; ++i) {
      s.red[i] = s.normal_x[i] * 0.5f + 0.5f;
      s.green[i] = s.normal_y[i] * 0.5f + 0.5f;
      s.blue[i] = s.normal_z[i] * 0.5f + 0.5f;
      tile.light[i] = 1;
    }
  }
  if (mode != ShadingMode::kDiffuse) return;
  if (has_textures_) apply_textures(tile);
  if (!has_unlit_) return;
  for (std::uint32_t i = 0; i < pixels; ++i) {
    const std::uint32_t triangle = tile.hits->triangle[i];
    if (triangle != kNoHit && is_unlit_[model_->triangle_materials[triangle]]) tile.light[i] = 1;
  }
}

void Shader::write_pixels(const Tile& tile, std::span<std::uint32_t> pixels) const {
  const SurfaceTile& s = tile.surface;
  const auto& srgb = srgb_table();
  alignas(64) std::int32_t red[kTileSide], green[kTileSide], blue[kTileSide];
  for (std::uint32_t row = 0; row < tile.rows; ++row) {
    const std::uint32_t first = row * kTileSide;
    for (std::uint32_t i = 0; i < kTileSide; ++i) {
      red[i] = srgb_step(s.red[first + i] * tile.light[first + i]);
      green[i] = srgb_step(s.green[first + i] * tile.light[first + i]);
      blue[i] = srgb_step(s.blue[first + i] * tile.light[first + i]);
    }
    const std::uint32_t y = tile.top + row;
    std::uint32_t* out = pixels.data() + std::size_t{y} * tile.image_width + tile.left;
    for (std::uint32_t i = 0; i < tile.columns; ++i) {
      const auto byte = [&](std::int32_t step) -> std::uint32_t {
        return srgb[static_cast<std::size_t>(step)];
      };
      out[i] = tile.hits->triangle[first + i] == kNoHit
                   ? background_[y]
                   : byte(red[i]) | byte(green[i]) << 8 | byte(blue[i]) << 16 | 0xff000000u;
    }
  }
}

void Shader::shade(const PosedMesh& mesh, const PinholeRays& rays, const HitBuffer& hits,
                   ShadingMode mode, std::span<std::uint32_t> pixels) {
  background_ = background_rows(hits.height());
  parallel_chunks(hits.height(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y)
      std::fill_n(pixels.data() + y * hits.width(), hits.width(), background_[y]);
  });
  std::vector<std::uint32_t> tiles;
  for (std::size_t i = 0; i < hits.tile_count(); ++i)
    if (hits.tile(i).written) tiles.push_back(static_cast<std::uint32_t>(i));

  vertex_normals_.update(mesh, hits, tiles);
  const ShadedMesh shaded = shaded_mesh(mesh, mode);
  parallel_chunks(tiles.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Tile tile(hits, tiles[i]);
      compute_surface(rays, tile.left, tile.top, shaded, *tile.hits, tile.rows, tile.surface);
      light_tile(mode, tile);
      write_pixels(tile, pixels);
    }
  });
}

}  // namespace mdk
