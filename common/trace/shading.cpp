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

/// Barycentric coordinates of the ray's meeting with the triangle's plane, clamped into it.
void barycentrics(const Vec3f (&corner)[3], const PinholeRays& rays, const Vec3f& direction,
                  float (&bary)[3]) {
  const Vec3f edge1 = corner[1] - corner[0], edge2 = corner[2] - corner[0];
  const Vec3f p = cross(direction, edge2);
  const float det = dot(edge1, p);
  const Vec3f from_a = rays.origin - corner[0];
  const float inv = det != 0 ? 1 / det : 0;
  const auto unit = [](float x) { return x > 0 ? std::min(x, 1.0f) : 0.0f; };
  const float u = unit(dot(from_a, p) * inv);
  const float v = unit(dot(direction, cross(from_a, edge1)) * inv);
  bary[1] = u;
  bary[2] = std::min(v, 1 - u);
  bary[0] = 1 - bary[1] - bary[2];
}

template <class T>
T blend(const T& a, const T& b, const T& c, const float (&bary)[3]) {
  return a * bary[0] + b * bary[1] + c * bary[2];
}

Vec3f unpack_linear(std::uint32_t rgba) {
  const auto channel = [rgba](int shift) {
    return static_cast<float>(rgba >> shift & 255u) / 255.0f;
  };
  return {channel(0), channel(8), channel(16)};
}

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

Shader::Shader(const Model& model) : model_(&model), triangle_cluster_(model.triangle_count()) {
  for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
    const Cluster& cluster = model.clusters[c];
    std::fill_n(triangle_cluster_.begin() + cluster.first_triangle, cluster.triangle_count, c);
  }
  first_corner_.assign(model.vertex_count + 1, 0);
  for (const Triangle& t : model.triangles)
    for (std::uint32_t v : t.v) ++first_corner_[v + 1];
  for (std::size_t v = 0; v < model.vertex_count; ++v) first_corner_[v + 1] += first_corner_[v];
  ring_.resize(first_corner_.back());
  std::vector<std::uint32_t> next(first_corner_.begin(), first_corner_.end() - 1);
  for (std::uint32_t t = 0; t < model.triangle_count(); ++t)
    for (std::uint32_t v : model.triangles[t].v) ring_[next[v]++] = t;
}

void Shader::compute_vertex_normals(const PosedMesh& mesh) {
  vertex_normals_.resize(model_->vertex_count);
  const std::span<const Vec3f> positions = mesh.positions();
  parallel_chunks(vertex_normals_.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Vec3f sum;  // weighted by area: a cross product is twice its triangle's
      for (std::uint32_t i = first_corner_[v]; i < first_corner_[v + 1]; ++i) {
        const Triangle& t = model_->triangles[ring_[i]];
        const Vec3f& a = positions[t.v[0]];
        sum += cross(positions[t.v[1]] - a, positions[t.v[2]] - a);
      }
      vertex_normals_[v] = sum;
    }
  });
}

Vec3f Shader::shading_normal(std::uint32_t triangle, const Vec3f& face_normal,
                             const float (&bary)[3]) const {
  const Material& material = model_->materials[model_->triangle_materials[triangle]];
  if (material.flags & kMaterialFlatShaded) return face_normal;
  const Triangle& t = model_->triangles[triangle];
  const auto corner = [&](int k) { return normalized(vertex_normals_[t.v[k]], face_normal); };
  const Vec3f n = normalized(blend(corner(0), corner(1), corner(2), bary), face_normal);
  return dot(n, face_normal) < 0 ? -n : n;
}

Vec3f Shader::base_color(std::uint32_t triangle, const float (&bary)[3]) const {
  const Material& material = model_->materials[model_->triangle_materials[triangle]];
  Vec3f color{material.base_color[0], material.base_color[1], material.base_color[2]};
  const std::size_t corner = std::size_t{3} * triangle;
  if (!model_->corner_colors.empty()) {
    const auto* c = &model_->corner_colors[corner];
    color =
        multiply(color, blend(unpack_linear(c[0]), unpack_linear(c[1]), unpack_linear(c[2]), bary));
  }
  if (material.texture != kNoTexture && !model_->corner_texcoords.empty()) {
    const auto* uv = &model_->corner_texcoords[corner];
    const TexCoord at{uv[0].u * bary[0] + uv[1].u * bary[1] + uv[2].u * bary[2],
                      uv[0].v * bary[0] + uv[1].v * bary[1] + uv[2].v * bary[2]};
    color = multiply(
        color, sample_texture(model_->textures[material.texture], model_->texels, at, material));
  }
  return color;
}

Vec3f Shader::shade_hit(const PosedMesh& mesh, const PinholeRays& rays, const Vec3f& direction,
                        std::uint32_t triangle, ShadingMode mode) const {
  Vec3f corner[3];
  for (std::size_t k = 0; k < 3; ++k)
    corner[k] = mesh.positions()[model_->triangles[triangle].v[k]];
  float bary[3];
  barycentrics(corner, rays, direction, bary);
  Vec3f face = normalized(cross(corner[1] - corner[0], corner[2] - corner[0]));
  Vec3f n = shading_normal(triangle, face, bary);
  if (dot(face, direction) > 0) n = -n;  // both sides are shown alike
  if (mode == ShadingMode::kNormals)
    return {n.x * 0.5f + 0.5f, n.y * 0.5f + 0.5f, n.z * 0.5f + 0.5f};

  const Vec3f color = mode == ShadingMode::kClusters ? cluster_color(triangle_cluster_[triangle])
                                                     : base_color(triangle, bary);
  const bool unlit =
      mode == ShadingMode::kDiffuse &&
      (model_->materials[model_->triangle_materials[triangle]].flags & kMaterialUnlit);
  if (unlit) return color;
  const float facing = std::max(0.0f, -dot(n, direction) / length(direction));
  return color * (kAmbient + (1 - kAmbient) * facing);
}

void Shader::shade(const PosedMesh& mesh, const PinholeRays& rays, const HitBuffer& hits,
                   ShadingMode mode, std::span<std::uint32_t> pixels) {
  compute_vertex_normals(mesh);
  const std::vector<std::uint32_t> background = background_rows(hits.height());
  parallel_chunks(hits.tile_count(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const TileHits& tile = hits.tile(i);
      const std::uint32_t left = hits.tile_left(i), top = hits.tile_top(i);
      const std::uint32_t right = std::min(left + kTileSide, hits.width());
      const std::uint32_t bottom = std::min(top + kTileSide, hits.height());
      for (std::uint32_t y = top; y < bottom; ++y) {
        const std::uint32_t* triangle = tile.triangle + (y - top) * kTileSide;
        std::uint32_t* pixel = pixels.data() + std::size_t{y} * hits.width() + left;
        for (std::uint32_t x = left; x < right; ++x, ++triangle, ++pixel) {
          if (*triangle == kNoHit) {
            *pixel = background[y];
            continue;
          }
          const Vec3f direction =
              rays.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
          *pixel = pack_srgb(shade_hit(mesh, rays, direction, *triangle, mode));
        }
      }
    }
  });
}

}  // namespace mdk
