#include "common/trace/scene_shading.h"

#include <algorithm>
#include <cmath>

#include "common/trace/color.h"
#include "common/trace/query_keys.h"

namespace mdk {
namespace {

constexpr float kAmbient = 0.12f;  // as a single model's

Vec3f linear_color(std::uint32_t rgba) {
  return {static_cast<float>(rgba & 255u) / 255, static_cast<float>(rgba >> 8 & 255u) / 255,
          static_cast<float>(rgba >> 16 & 255u) / 255};
}

Vec3f product(const Vec3f& a, const Vec3f& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

/// What a pixel sees of a triangle.
struct SeenSurface {
  float weight[3];  ///< barycentric coordinates
  Vec3f normal;     ///< unit, in the world, to the eye
  float facing;     ///< cosine between it and the way to the eye
};

/// The transpose of a map's linear part.
Vec3f turned_back(const Affine3f& model_from_world, const Vec3f& n) {
  const auto& m = model_from_world.m;
  return {m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z,
          m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
          m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z};
}

/// An instance while its pixels of a tile are shaded.
struct Shaded {
  const InstanceRays* rays = nullptr;
  const CrowdModel* crowd = nullptr;
  Affine3f model_from_world;
  const std::uint32_t* places = nullptr;  ///< of vertices in poses
  const Vec3f* from_normals = nullptr;
  const Vec3f* to_normals = nullptr;
  Vec3f tint;
  std::uint32_t number = kNoHit, model = 0;

  Vec3f position(std::uint32_t vertex) const { return rays->vertices.position(places[vertex]); }

  Vec3f normal(std::uint32_t vertex) const {
    if (from_normals == nullptr) {
      Vec3f sum{};  // weighted by area: a cross product is twice its triangle's
      for (const std::uint32_t around : crowd->triangles_around(vertex)) {
        const Triangle& t = crowd->model().triangles[around];
        const Vec3f a = position(t.v[0]);
        sum += cross(position(t.v[1]) - a, position(t.v[2]) - a);
      }
      return normalized(sum, Vec3f{});
    }
    const Vec3f& a = from_normals[vertex];
    return a + (to_normals[vertex] - a) * rays->time.s;
  }

  SeenSurface surface(const Triangle& t, bool is_flat, const Vec3f& direction,
                      const Vec3f& world_direction) const {
    const Vec3f origin = rays->rays.origin;
    const Vec3f a = position(t.v[0]) - origin, b = position(t.v[1]) - origin,
                c = position(t.v[2]) - origin;
    const Vec3f face = cross(b - a, c - a);
    // Weights by their distance from the ray, with the corners seen from one of them: what cancels
    // is small then.
    SeenSurface s;
    const float along = dot(face, direction);
    const Vec3f p = direction * (along != 0 ? dot(face, a) / along : 0.0f);
    const float square = dot(face, face);
    const float w1 = square > 0 ? dot(face, cross(c - p, a - p)) / square : 0.0f,
                w2 = square > 0 ? dot(face, cross(a - p, b - p)) / square : 0.0f;
    s.weight[1] = std::clamp(w1, 0.0f, 1.0f);
    s.weight[2] = std::clamp(w2, 0.0f, 1.0f - s.weight[1]);
    s.weight[0] = 1 - s.weight[1] - s.weight[2];
    const Vec3f way = normalized(world_direction * -1.0f);
    Vec3f face_normal = normalized(turned_back(model_from_world, face));
    if (dot(face_normal, way) < 0) face_normal = face_normal * -1.0f;
    s.normal = face_normal;
    if (!is_flat) {
      Vec3f n{};
      for (int k = 0; k < 3; ++k) n += normal(t.v[k]) * s.weight[k];
      n = normalized(turned_back(model_from_world, n), face_normal);
      s.normal = dot(n, face_normal) < 0 ? n * -1.0f : n;
    }
    s.facing = std::clamp(dot(s.normal, way), 0.0f, 1.0f);
    return s;
  }
};

}  // namespace

bool is_scene_shading(ShadingMode mode) {
  return mode == ShadingMode::kDiffuse || mode == ShadingMode::kNormals ||
         mode == ShadingMode::kClusters;
}

SceneShader::SceneShader(const Stage& stage, std::span<const std::unique_ptr<CrowdModel>> models)
    : stage_(stage), models_(models) {
  for (const auto& crowd : models) {
    const ModelView& model = crowd->model();
    ModelColors& colors = colors_.emplace_back();
    colors.triangle_cluster.resize(model.triangle_count());
    for (std::uint32_t c = 0; c < model.cluster_count(); ++c)
      std::fill_n(colors.triangle_cluster.begin() + model.clusters[c].first_triangle,
                  model.clusters[c].triangle_count, c);
  }
}

void SceneShader::shade_tile(const CrowdFrame& frame, ShadingMode mode, std::uint32_t left,
                             std::uint32_t top, const TileHits& hits,
                             const TileInstances& instances, InstancePool& pool, Film& film) const {
  alignas(64) float red[kTilePixels], green[kTilePixels], blue[kTilePixels];
  Shaded at;
  for (std::uint32_t i = 0; i < kTilePixels; ++i) {
    red[i] = green[i] = blue[i] = 0;
    const std::uint32_t number = hits.triangle[i];
    const bool is_inside = left + i % kTileSide < frame.width && top + i / kTileSide < frame.height;
    if (number == kNoHit || !is_inside) continue;
    if (at.number != instances.instance[i]) {
      at.number = instances.instance[i];
      at.rays = pool.enter(at.number);
      at.model = stage_.role(at.number).model;
      at.crowd = models_[at.model].get();
      at.model_from_world = to_float(stage_.model_from_world(at.number, frame.time));
      at.places = at.crowd->tracer().rays().poses->places();
      const bool kept = at.crowd->keeps_normals();
      at.from_normals = kept ? at.crowd->normals(at.rays->time.key0).data() : nullptr;
      at.to_normals = kept ? at.crowd->normals(at.rays->time.key1).data() : nullptr;
      at.tint = linear_color(stage_.scene().labels[at.number].tint);
    }
    const ModelView& model = at.crowd->model();
    const float x = static_cast<float>(left + i % kTileSide) + 0.5f,
                y = static_cast<float>(top + i / kTileSide) + 0.5f;
    const Vec3f direction = at.rays->rays.direction(x - at.rays->shift_x, y - at.rays->shift_y);
    const auto& looks = model.appearance;
    const Material& material = looks.materials[looks.triangle_materials[number]];
    const Triangle& triangle = model.triangles[number];
    const SeenSurface s = at.surface(triangle, (material.flags & kMaterialFlatShaded) != 0,
                                     direction, frame.rays.direction(x, y));
    Vec3f color;
    if (mode == ShadingMode::kNormals) {
      color = s.normal * 0.5f + Vec3f{0.5f, 0.5f, 0.5f};
    } else if (mode == ShadingMode::kClusters) {
      color = cluster_color(colors_[at.model].triangle_cluster[number]);
    } else {
      color = {material.base_color[0], material.base_color[1], material.base_color[2]};
      if (!looks.corner_colors.empty()) {
        Vec3f mixed{};
        for (std::uint32_t k = 0; k < 3; ++k)
          mixed += linear_color(looks.corner_colors[std::size_t{3} * number + k]) * s.weight[k];
        color = product(color, mixed);
      }
      color = product(color, at.tint);
    }
    if (mode != ShadingMode::kNormals) {
      const bool is_plain = mode == ShadingMode::kDiffuse && (material.flags & kMaterialUnlit) != 0;
      color = color * (is_plain ? 1.0f : kAmbient + (1 - kAmbient) * s.facing);
    }
    red[i] = color.x;
    green[i] = color.y;
    blue[i] = color.z;
  }
  film.put_tile(left, top, {red, green, blue, hits.triangle});
}

}  // namespace mdk
