#include "common/trace/surface.h"

#include "common/trace/color.h"

namespace mdk {
namespace {

/// Where velocities are taken from: the keys around a time, of which the second is the later one.
/// At a key, the interval that begins there, or at a clip's last key the one that ends there.
struct Motion {
  std::uint32_t key0, key1;
  double seconds = 0;  ///< 0: the clip has one key, nothing moves
};

Motion motion_at(const ModelView& model, const KeyInterval& at) {
  Motion motion{at.key0, at.key1};
  if (at.key0 == at.key1) {
    const Clip& clip = model.clips[clip_of_key(model, at.key0)];
    if (clip.key_count == 1) return motion;
    if (at.key0 + 1 < clip.first_key + clip.key_count) {
      motion.key1 = at.key0 + 1;
    } else {
      motion.key0 = at.key0 - 1;
    }
  }
  motion.seconds = model.key_times[motion.key1] - model.key_times[motion.key0];
  return motion;
}

Vec3d mix(const Vec3d (&corner)[3], const double (&weight)[3]) {
  return corner[0] * weight[0] + corner[1] * weight[1] + corner[2] * weight[2];
}

}  // namespace

const Surfaces::Around& Surfaces::around() const {
  std::call_once(once_, [&] {
    const ModelView& model = tracer_.model();
    around_.first.assign(std::size_t{model.vertex_count} + 1, 0);
    for (const Triangle& t : model.triangles)
      for (const std::uint32_t v : t.v) ++around_.first[v + 1];
    for (std::size_t v = 0; v < model.vertex_count; ++v) around_.first[v + 1] += around_.first[v];
    around_.triangles.resize(around_.first.back());
    std::vector<std::uint32_t> next(around_.first.begin(), around_.first.end() - 1);
    for (std::uint32_t t = 0; t < model.triangle_count(); ++t)
      for (const std::uint32_t v : model.triangles[t].v) around_.triangles[next[v]++] = t;
  });
  return around_;
}

// As pictures are shaded: weighted by area, since a cross product is twice its triangle's.
Vec3f Surfaces::vertex_normal(std::uint32_t vertex, const HeldVertices& vertices) const {
  const Around& lists = around();
  Vec3f sum;
  for (std::uint32_t i = lists.first[vertex]; i < lists.first[vertex + 1]; ++i) {
    const Triangle& t = tracer_.model().triangles[lists.triangles[i]];
    const Vec3f a = vertices.position(t.v[0]);
    sum += cross(vertices.position(t.v[1]) - a, vertices.position(t.v[2]) - a);
  }
  return normalized(sum, Vec3f{});
}

void Surfaces::set_geometry(const Triangle& triangle, const double (&weight)[3],
                            const KeyInterval& time, bool is_smooth, Surface& surface) const {
  const HeldVertices vertices(tracer_, time);
  Vec3d corner[3];
  for (int k = 0; k < 3; ++k) corner[k] = to_double(vertices.position(triangle.v[k]));
  surface.position = to_float(mix(corner, weight));
  surface.normal =
      to_float(normalized(cross(corner[1] - corner[0], corner[2] - corner[0]), Vec3d{}));
  surface.smooth_normal = surface.normal;
  if (!is_smooth) return;
  Vec3d normal[3];
  for (int k = 0; k < 3; ++k) normal[k] = to_double(vertex_normal(triangle.v[k], vertices));
  surface.smooth_normal = to_float(normalized(mix(normal, weight), to_double(surface.normal)));
}

Surface Surfaces::at(const QueryHit& hit, const KeyInterval& time, SurfaceParts parts) const {
  const ModelView& model = tracer_.model();
  const Triangle& triangle = model.triangles[hit.triangle];
  const double b1 = static_cast<double>(hit.bary1), b2 = static_cast<double>(hit.bary2);
  const double weight[3] = {1 - b1 - b2, b1, b2};

  Surface surface;
  surface.source_triangle = model.source_triangles[hit.triangle];
  surface.material = model.appearance.triangle_materials[hit.triangle];
  const Material& material = model.appearance.materials[surface.material];
  set_geometry(
      triangle, weight, time,
      has(parts, SurfaceParts::kSmoothNormal) && (material.flags & kMaterialFlatShaded) == 0,
      surface);
  if (has(parts, SurfaceParts::kVelocity)) {
    const Motion motion = motion_at(model, time);
    if (motion.seconds > 0) {
      const HeldVertices ends(tracer_, {motion.key0, motion.key1, 0});
      const Vec3d moved[3] = {ends.moved(triangle.v[0]), ends.moved(triangle.v[1]),
                              ends.moved(triangle.v[2])};
      surface.velocity = to_float(mix(moved, weight) * (1 / motion.seconds));
    }
  }
  if (has(parts, SurfaceParts::kPaint)) {
    const auto& look = model.appearance;
    double color[4] = {material.base_color[0], material.base_color[1], material.base_color[2],
                       material.base_color[3]};
    const std::size_t first = std::size_t{3} * hit.triangle;
    if (!look.corner_colors.empty()) {
      for (int channel = 0; channel < 4; ++channel) {
        double mixed = 0;
        for (std::size_t k = 0; k < 3; ++k)
          mixed += weight[k] * (look.corner_colors[first + k] >> (8 * channel) & 255u) / 255.0;
        color[channel] *= mixed;
      }
    }
    if (!look.corner_texcoords.empty()) {
      double u = 0, v = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        u += weight[k] * static_cast<double>(look.corner_texcoords[first + k].u);
        v += weight[k] * static_cast<double>(look.corner_texcoords[first + k].v);
      }
      surface.u = static_cast<float>(u);
      surface.v = static_cast<float>(v);
      if (material.texture != kNoTexture) {
        const Vec3f texel = sample_texture(look.textures[material.texture], look.texels,
                                           {surface.u, surface.v}, material);
        for (std::size_t k = 0; k < 3; ++k) color[k] *= static_cast<double>(texel[k]);
      }
    }
    for (int k = 0; k < 4; ++k) surface.base_color[k] = static_cast<float>(color[k]);
  }
  return surface;
}

}  // namespace mdk
