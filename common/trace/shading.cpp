// From hits to pixels: the vertices that are seen get their normals, each tile its surface, colours
// and light, and the film what comes of it.
#include "common/trace/shading.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/trace/color.h"
#include "common/trace/kernels/surface_kernel.h"

namespace mdk {

std::span<const ShadingInfo> shading_table() {
  static constexpr ShadingInfo kTable[] = {
      {ShadingMode::kDiffuse, "diffuse", "Diffuse"},
      {ShadingMode::kNormals, "normals", "Normals"},
      {ShadingMode::kLit, "lit", "Lit"},
      {ShadingMode::kClusters, "clusters", "Clusters"},
      {ShadingMode::kBoxes, "boxes", "Boxes"},
      {ShadingMode::kTests, "tests", "Tests"},
      {ShadingMode::kResidual, "residual", "Residual"},
      {ShadingMode::kAffine, "affine", "Affine motion"},
  };
  return kTable;
}

std::string_view shading_id(ShadingMode mode) {
  for (const ShadingInfo& row : shading_table())
    if (row.mode == mode) return row.id;
  return {};
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

namespace {

constexpr float kAmbient = 0.12f;
constexpr float kAmbientOfHeat = 0.7f;  ///< shape shows, colours stay those of the scale
constexpr float kUnhitWork = 0.45f;     ///< how bright work is where nothing was hit

constexpr std::size_t kMarksPerChunk = 4096;

/// Calls visit(i) where marks[i] is `mark`. What is seen lies together, and so does what is not.
template <class Visit>
void for_each_marked(std::span<const std::uint8_t> marks, std::uint8_t mark, const Visit& visit) {
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i] != mark) {
      const void* next = std::memchr(marks.data() + i, mark, marks.size() - i);
      if (next == nullptr) return;
      i = static_cast<std::size_t>(static_cast<const std::uint8_t*>(next) - marks.data());
    }
    visit(i);
  }
}

/// Threads that mark the same thing store the same byte.
void store(std::uint8_t& place, std::uint8_t mark) {
  std::atomic_ref(place).store(mark, std::memory_order_relaxed);
}

/// Where the vertices that a picture shows are, and their smooth normals.
class SeenVertices {
 public:
  explicit SeenVertices(const ModelView& model)
      : model_(&model),
        seen_triangles_(std::size_t{model.triangle_count()} + 1, 0),
        seen_vertices_(model.vertex_count, 0),
        vertices_(model.vertex_count) {
    first_corner_.assign(std::size_t{model.vertex_count} + 1, 0);
    for (const Triangle& t : model.triangles)
      for (std::uint32_t v : t.v) ++first_corner_[v + 1];
    for (std::size_t v = 0; v < model.vertex_count; ++v) first_corner_[v + 1] += first_corner_[v];
    ring_.resize(first_corner_.back());
    std::vector<std::uint32_t> next(first_corner_.begin(), first_corner_.end() - 1);
    for (std::uint32_t t = 0; t < model.triangle_count(); ++t)
      for (std::uint32_t v : model.triangles[t].v) ring_[next[v]++] = t;
  }

  /// The corners of all triangles in those tiles of `hits`, in the current pose. Runs in parallel.
  /// Cost: O(hits + vertices seen); hidden parts of the mesh cost a byte's look per triangle and
  /// vertex, and are not posed.
  void update(const PosedMesh& mesh, const HitBuffer& hits, std::span<const std::uint32_t> tiles) {
    mark(hits, tiles);
    parallel_chunks(model_->clusters.size(), 1, [&](std::size_t c, std::size_t) {
      const Cluster& cluster = model_->clusters[c];
      const std::uint8_t* marks = seen_triangles_.data() + cluster.first_triangle;
      if (std::memchr(marks, frame_, cluster.triangle_count) != nullptr)
        mesh.require_around(static_cast<std::uint32_t>(c));
    });
    const Vec3f* positions = mesh.posed_so_far();
    parallel_chunks(vertices_.size(), kMarksPerChunk, [&](std::size_t begin, std::size_t end) {
      const std::span marks(seen_vertices_.data() + begin, end - begin);
      for_each_marked(marks, frame_, [&](std::size_t i) {
        vertices_[begin + i] = make(static_cast<std::uint32_t>(begin + i), positions);
      });
    });
  }

  /// One per vertex; those of vertices that are not seen are out of date. A normal is zero where
  /// the triangles around the vertex have no direction.
  const SurfaceVertex* data() const { return vertices_.data(); }

 private:
  void mark(const HitBuffer& hits, std::span<const std::uint32_t> tiles) {
    if (++frame_ == 0) {  // wrapped round: old marks would look new
      std::fill(seen_triangles_.begin(), seen_triangles_.end(), std::uint8_t{0});
      std::fill(seen_vertices_.begin(), seen_vertices_.end(), std::uint8_t{0});
      frame_ = 1;
    }
    // Without branches: where the next triangle begins cannot be predicted.
    const std::uint32_t none = model_->triangle_count();
    parallel_chunks(tiles.size(), 8, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (const std::uint32_t triangle : hits.tile(tiles[i]).triangle)
          store(seen_triangles_[std::min(triangle, none)], frame_);
    });
    parallel_chunks(none, kMarksPerChunk, [&](std::size_t begin, std::size_t end) {
      const std::span marks(seen_triangles_.data() + begin, end - begin);
      for_each_marked(marks, frame_, [&](std::size_t i) {
        for (const std::uint32_t v : model_->triangles[begin + i].v)
          store(seen_vertices_[v], frame_);
      });
    });
  }

  SurfaceVertex make(std::uint32_t vertex, const Vec3f* positions) const {
    Vec3f sum;  // weighted by area: a cross product is twice its triangle's
    for (std::uint32_t i = first_corner_[vertex]; i < first_corner_[vertex + 1]; ++i) {
      const Triangle& t = model_->triangles[ring_[i]];
      const Vec3f& a = positions[t.v[0]];
      sum += cross(positions[t.v[1]] - a, positions[t.v[2]] - a);
    }
    return {.position = positions[vertex], .normal = normalized(sum, Vec3f{})};
  }

  const ModelView* model_;
  std::vector<std::uint32_t> first_corner_;  ///< per vertex: where its triangles begin in ring_
  std::vector<std::uint32_t> ring_;
  /// Equal to frame_ where it is seen. One triangle more stands for "no hit".
  std::vector<std::uint8_t> seen_triangles_, seen_vertices_;
  std::uint8_t frame_ = 0;
  std::vector<SurfaceVertex> vertices_;
};

/// One tile on its way from hits to the film.
struct Tile {
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
struct Scratch {
  SurfaceTile surface{};
  Lighting::Scratch lighting;
};

}  // namespace

struct Shader::State {
  explicit State(const ModelView& m)
      : model(m),
        triangle_cluster(model.triangle_count()),
        is_flat(model.triangle_count()),
        vertices(model) {
    for (std::uint32_t c = 0; c < model.cluster_count(); ++c) {
      const Cluster& cluster = model.clusters[c];
      std::fill_n(triangle_cluster.begin() + cluster.first_triangle, cluster.triangle_count, c);
      cluster_colors.push_back(cluster_color(c));
    }
    for (const Material& material : model.appearance.materials) {
      const float* color = material.base_color;
      material_colors.push_back({color[0], color[1], color[2]});
      is_unlit_material.push_back((material.flags & kMaterialUnlit) != 0);
      has_unlit = has_unlit || is_unlit_material.back() != 0;
      has_textures = has_textures || material.texture != kNoTexture;
    }
    has_textures = has_textures && !model.appearance.corner_texcoords.empty();
    for (std::size_t t = 0; t < is_flat.size(); ++t) {
      const Material& material = model.appearance.materials[model.appearance.triangle_materials[t]];
      is_flat[t] = (material.flags & kMaterialFlatShaded) != 0;
    }
  }

  ShadedMesh shaded_mesh(ShadingMode mode) const {
    ShadedMesh shaded{};
    shaded.triangles = model.triangles.data();
    shaded.vertices = vertices.data();
    shaded.is_flat = is_flat.data();
    if (mode == ShadingMode::kClusters) {
      shaded.palette = cluster_colors.data();
      shaded.palette_index = triangle_cluster.data();
    } else if (mode == ShadingMode::kResidual) {
      shaded.palette = heat.palette().data();
      shaded.palette_index = heat.triangle_colors().data();
    } else {
      shaded.palette = material_colors.data();
      shaded.palette_index = model.appearance.triangle_materials.data();
      if (!model.appearance.corner_colors.empty())
        shaded.corner_colors = model.appearance.corner_colors.data();
    }
    return shaded;
  }

  SurfaceOptions requested(ShadingMode mode) const {
    const bool is_lit = mode == ShadingMode::kLit;
    const bool shows_paint = is_lit || mode == ShadingMode::kDiffuse;
    return {.facing = !is_lit && mode != ShadingMode::kNormals,
            .normals = is_lit || mode == ShadingMode::kNormals,
            .barycentrics = is_lit || (shows_paint && has_textures)};
  }

  void apply_textures(Tile& tile) const {
    SurfaceTile& s = tile.surface;
    for (std::uint32_t i = 0; i < tile.rows * kTileSide; ++i) {
      const std::uint32_t triangle = tile.hits->triangle[i];
      if (triangle == kNoHit) continue;
      const Material& material =
          model.appearance.materials[model.appearance.triangle_materials[triangle]];
      if (material.texture == kNoTexture) continue;
      const float bary[3] = {1 - s.bary1[i] - s.bary2[i], s.bary1[i], s.bary2[i]};
      const auto* uv = &model.appearance.corner_texcoords[std::size_t{3} * triangle];
      const TexCoord at{uv[0].u * bary[0] + uv[1].u * bary[1] + uv[2].u * bary[2],
                        uv[0].v * bary[0] + uv[1].v * bary[1] + uv[2].v * bary[2]};
      const Vec3f texel = sample_texture(model.appearance.textures[material.texture],
                                         model.appearance.texels, at, material);
      s.red[i] *= texel.x;
      s.green[i] *= texel.y;
      s.blue[i] *= texel.z;
    }
  }

  HeatScale prepare_heat(const ShadingInput& input, ShadingMode mode) {
    switch (mode) {
      case ShadingMode::kBoxes:
        return heat.color_tiles(input.tile_work, &TraceCounters::node_visits, "visits per ray");
      case ShadingMode::kTests:
        return heat.color_tiles(input.tile_work, &TraceCounters::triangle_tests, "tests per ray");
      case ShadingMode::kResidual:
        return heat.color_triangles(input.mesh);
      default:
        return {};
    }
  }

  bool is_unlit(std::uint32_t triangle) const {
    return triangle != kNoHit &&
           is_unlit_material[model.appearance.triangle_materials[triangle]] != 0;
  }

  void show_normals(Tile& tile) const {
    SurfaceTile& s = tile.surface;
    for (std::uint32_t i = 0; i < tile.rows * kTileSide; ++i) {
      s.red[i] = s.normal_x[i] * 0.5f + 0.5f;
      s.green[i] = s.normal_y[i] * 0.5f + 0.5f;
      s.blue[i] = s.normal_z[i] * 0.5f + 0.5f;
    }
  }

  void show_work(Tile& tile) const {
    SurfaceTile& s = tile.surface;
    const Vec3f& color = heat.tile_color(tile.number);
    for (std::uint32_t i = 0; i < kTilePixels; ++i) {
      const bool is_hit = tile.is_hit && tile.hits->triangle[i] != kNoHit;
      const float light = is_hit ? kAmbientOfHeat + (1 - kAmbientOfHeat) * s.facing[i] : kUnhitWork;
      s.red[i] = color.x * light;
      s.green[i] = color.y * light;
      s.blue[i] = color.z * light;
    }
    tile.shows_misses = true;
  }

  /// A headlight; `edge_light` is what light is left where the surface is seen edge-on.
  void light_from_eye(ShadingMode mode, float edge_light, Tile& tile) const {
    SurfaceTile& s = tile.surface;
    alignas(64) float light[kTilePixels];
    const std::uint32_t pixels = tile.rows * kTileSide;
    for (std::uint32_t i = 0; i < pixels; ++i)
      light[i] = edge_light + (1 - edge_light) * s.facing[i];
    const bool some_plain = mode == ShadingMode::kDiffuse && has_unlit;
    for (std::uint32_t i = 0; some_plain && i < pixels; ++i)
      if (is_unlit(tile.hits->triangle[i])) light[i] = 1;
    for (std::uint32_t i = 0; i < pixels; ++i) {
      s.red[i] *= light[i];
      s.green[i] *= light[i];
      s.blue[i] *= light[i];
    }
  }

  /// Returns how many rays were traced.
  std::uint64_t light_from_lamps(const Lighting& lighting, const ShadedMesh& mesh,
                                 Lighting::Scratch& scratch, Tile& tile) const {
    if (has_textures) apply_textures(tile);
    SurfaceTile& s = tile.surface;
    LightTile light;
    const std::uint64_t rays =
        lighting.light_tile({mesh, *tile.hits, s, tile.columns, tile.rows}, scratch, light);
    for (std::uint32_t i = 0; i < tile.rows * kTileSide; ++i) {
      if (has_unlit && is_unlit(tile.hits->triangle[i])) continue;
      s.red[i] *= light.red[i];
      s.green[i] *= light.green[i];
      s.blue[i] *= light.blue[i];
    }
    return rays;
  }

  /// Every mode but kLit.
  void show_tile(ShadingMode mode, Tile& tile) const {
    switch (mode) {
      case ShadingMode::kNormals:
        return show_normals(tile);
      case ShadingMode::kBoxes:
      case ShadingMode::kTests:
        return show_work(tile);
      case ShadingMode::kResidual:
        return light_from_eye(mode, kAmbientOfHeat, tile);
      case ShadingMode::kDiffuse:
        if (has_textures) apply_textures(tile);
        return light_from_eye(mode, kAmbient, tile);
      default:
        return light_from_eye(mode, kAmbient, tile);
    }
  }

  /// A tile that some ray hits, or that shows how much work it was. Returns how many rays were
  /// traced.
  std::uint64_t shade_tile(const ShadingInput& input, ShadingMode mode, Tile& tile,
                           Scratch& scratch) const {
    const ShadedMesh mesh = shaded_mesh(mode);
    if (tile.is_hit)
      compute_surface(input.rays, tile.left, tile.top, mesh, *tile.hits, requested(mode),
                      tile.surface);
    if (mode == ShadingMode::kLit)
      return light_from_lamps(*input.lighting, mesh, scratch.lighting, tile);
    show_tile(mode, tile);
    return 0;
  }

  ShadingReport shade(const ShadingInput& input, ShadingMode mode, Film& film) {
    const HitBuffer& hits = input.hits;
    std::vector<std::uint32_t> hit_tiles;
    for (std::size_t i = 0; i < hits.tile_count(); ++i)
      if (hits.is_hit(i)) hit_tiles.push_back(static_cast<std::uint32_t>(i));
    vertices.update(input.mesh, hits, hit_tiles);

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

  const ModelView& model;
  std::vector<Vec3f> material_colors, cluster_colors;
  std::vector<std::uint32_t> triangle_cluster;
  std::vector<std::uint8_t> is_flat;            ///< per triangle
  std::vector<std::uint8_t> is_unlit_material;  ///< per material
  bool has_unlit = false, has_textures = false;
  SeenVertices vertices;
  HeatMap heat;
};

Shader::Shader(const ModelView& model) : state_(std::make_unique<State>(model)) {}
Shader::~Shader() = default;

ShadingReport Shader::shade(const ShadingInput& input, ShadingMode mode, Film& film) {
  return state_->shade(input, mode, film);
}

}  // namespace mdk
