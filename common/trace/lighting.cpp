#include "common/trace/lighting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mdk {
namespace {

constexpr Vec3f kKeyLight{0.80f, 0.76f, 0.68f};
constexpr Vec3f kSky{0.46f, 0.51f, 0.60f};
constexpr Vec3f kGround{0.17f, 0.15f, 0.13f};
constexpr double kKeyRadius = 0.025;  ///< of the key light's disc, seen from 1 away

/// Classes of pixels: each square of this side has one of each.
constexpr std::uint32_t kInterleave = 2;
constexpr std::uint32_t kClasses = kInterleave * kInterleave;
constexpr std::uint32_t kClassPixels = kTilePixels / kClasses;

/// Pixels of a tile in the order rays are made: class by class, and in each by squares, so that the
/// sixteen rays of a group start close together.
template <std::uint32_t Side>
std::array<std::uint8_t, kTilePixels> pixel_order() {
  constexpr std::uint32_t kSquare = 4, kRow = kTileSide / Side;
  std::array<std::uint8_t, kTilePixels> order{};
  std::size_t next = 0;
  for (std::uint32_t c = 0; c < Side * Side; ++c)
    for (std::uint32_t square = 0; square < kRow * kRow / (kSquare * kSquare); ++square)
      for (std::uint32_t i = 0; i < kSquare * kSquare; ++i) {
        const std::uint32_t x = square % (kRow / kSquare) * kSquare + i % kSquare;
        const std::uint32_t y = square / (kRow / kSquare) * kSquare + i / kSquare;
        order[next++] =
            static_cast<std::uint8_t>((y * Side + c / Side) * kTileSide + x * Side + c % Side);
      }
  return order;
}

double cosine(double turns) { return std::cos(2 * std::numbers::pi * turns); }
double sine(double turns) { return std::sin(2 * std::numbers::pi * turns); }

Vec3f normal_of(const LitTile& tile, std::size_t pixel) {
  const SurfaceTile& s = tile.surface;
  return {s.normal_x[pixel], s.normal_y[pixel], s.normal_z[pixel]};
}

void add_light(LightTile& light, std::size_t pixel, const Vec3f& more) {
  light.red[pixel] += more.x;
  light.green[pixel] += more.y;
  light.blue[pixel] += more.z;
}

/// Darkens where a smooth normal still faces the light but its triangle hardly does, so that the
/// triangle's own shadow does not begin with an edge (Chiang, Li, Burley 2019).
float softened_terminator(float face, float smooth, float between) {
  const float g = face / std::max(smooth * between, 1e-6f);
  if (g >= 1) return 1;
  return ((1 - g) * g + 1) * g;
}

}  // namespace

Lighting::Lighting(const Technique& technique, const PinholeRays& rays, const Aabb& mesh)
    : technique_(technique) {
  const Aabb bounds = mesh.empty() ? Aabb{{0, 0, 0}, {0, 0, 0}} : mesh;
  center_ = bounds.center();
  eye_ = rays.origin - center_;
  right_ = normalized(rays.du, {1, 0, 0});
  up_ = -normalized(rays.dv, {0, -1, 0});
  const Vec3f extent = bounds.extent();
  const float reach = std::max(extent.x + extent.y + extent.z, 1e-30f);
  // Positions round to 2^-24 of their distance from the centre; corners and origins are a few such
  // roundings off, and rays start well above all of them.
  step_off_ = 0x1p-17f * reach;
  scale_ = std::ldexp(1.0f, -std::ilogb(reach));
}

Vec3f Lighting::ambient_light(const Vec3f& direction) const {
  const float high = 0.5f + 0.5f * dot(direction, up_);
  return kSky * high + kGround * (1 - high);
}

void Lighting::choose_directions(std::uint32_t occlusion_rays, std::uint32_t sample) {
  const EvenPoint in_disc(sample);
  const double radius = kKeyRadius * std::sqrt(EvenPoint::fraction(in_disc.x - 0.5));
  const Vec3f toward_eye = cross(right_, up_);
  to_key_ =
      normalized(right_ * static_cast<float>(-0.55 + radius * cosine(in_disc.y)) +
                 up_ * static_cast<float>(0.75 + radius * sine(in_disc.y)) + toward_eye * 0.65f);

  axes_.clear();
  axes_per_class_ = occlusion_rays;
  for (std::uint32_t c = 0; c < kClasses; ++c) {
    // A spiral of equal parts of the hemisphere, shifted for each class.
    const EvenPoint shift(sample * kClasses + c);
    for (std::uint32_t i = 0; i < occlusion_rays; ++i) {
      const double z = (i + shift.x) / occlusion_rays;
      const double across = std::sqrt(1 - z * z), part = i / std::numbers::phi + shift.y;
      axes_.push_back(to_float(Vec3d{across * cosine(part), across * sine(part), z}));
    }
  }
}

std::uint64_t Lighting::light_tile(const LitTile& tile, Scratch& scratch, LightTile& light) const {
  find_origins(tile, scratch);
  std::fill_n(light.red, kTilePixels, 0.0f);
  std::fill_n(light.green, kTilePixels, 0.0f);
  std::fill_n(light.blue, kTilePixels, 0.0f);
  std::uint64_t rays = 0;
  if (axes_per_class_ == 0) {
    add_open_sky(tile, scratch, light);
  } else {
    rays += add_sky(tile, scratch, light);
  }
  return rays + add_key_light(tile, scratch, light);
}

void Lighting::find_origins(const LitTile& tile, Scratch& scratch) const {
  for (std::uint32_t i = 0; i < kTilePixels; ++i) {
    const std::uint32_t triangle = tile.hits.triangle[i];
    scratch.is_lit[i] =
        triangle != kNoHit && i % kTileSide < tile.columns && i / kTileSide < tile.rows;
    if (!scratch.is_lit[i]) continue;
    const std::uint32_t* v = tile.mesh.triangles[triangle].v;
    const Vec3f& first = tile.mesh.vertices[v[0]].position;
    const Vec3f a = first - center_;
    const Vec3f ab = tile.mesh.vertices[v[1]].position - first;
    const Vec3f ac = tile.mesh.vertices[v[2]].position - first;
    const Vec3f point = a + ab * tile.surface.bary1[i] + ac * tile.surface.bary2[i];
    const Vec3f face = normalized(cross(ab, ac));
    scratch.face_normal[i] = dot(face, eye_ - a) < 0 ? -face : face;
    scratch.origin[i] = point + scratch.face_normal[i] * step_off_;
  }
}

void Lighting::add_open_sky(const LitTile& tile, const Scratch& scratch, LightTile& light) const {
  for (std::size_t i = 0; i < kTilePixels; ++i)  // directions by the cosine are 2/3 n on average
    if (scratch.is_lit[i]) add_light(light, i, ambient_light(normal_of(tile, i) * (2.0f / 3)));
}

std::uint64_t Lighting::add_sky(const LitTile& tile, Scratch& scratch, LightTile& light) const {
  static const std::array<std::uint8_t, kTilePixels> order = pixel_order<kInterleave>();
  std::fill_n(scratch.weight, kTilePixels, 0.0f);
  std::uint64_t rays = 0;
  for (std::uint32_t c = 0; c < kClasses; ++c) {
    const std::span pixels(order.data() + c * kClassPixels, kClassPixels);
    for (std::size_t i = 0; i < axes_per_class_; ++i)
      rays += look_along(axes_[c * axes_per_class_ + i], pixels, tile, scratch, light);
  }
  for (std::size_t i = 0; i < kTilePixels; ++i) {
    if (!scratch.is_lit[i]) continue;
    const float share = scratch.weight[i] > 0 ? 1 / scratch.weight[i] : 0.0f;
    light.red[i] *= share;
    light.green[i] *= share;
    light.blue[i] *= share;
  }
  return rays;
}

std::uint64_t Lighting::look_along(const Vec3f& axis, std::span<const std::uint8_t> pixels,
                                   const LitTile& tile, Scratch& scratch, LightTile& light) const {
  // A pixel looks along whichever end of the axis is above its triangle.
  const Vec3f directions[2] = {axis, -axis};
  for (std::size_t end = 0; end < 2; ++end)
    scratch.beams[end].clear(make_beam_basis(directions[end], center_, scale_));
  for (const std::uint8_t pixel : pixels) {
    if (!scratch.is_lit[pixel]) continue;
    const std::size_t end = dot(scratch.face_normal[pixel], axis) < 0 ? 1 : 0;
    const float weight = dot(normal_of(tile, pixel), directions[end]);
    if (!(weight > 0)) continue;
    RayBeam& beam = scratch.beams[end];
    scratch.pixel_of_ray[end][beam.count] = pixel;
    scratch.weight_of_ray[end][beam.count] = weight;
    beam.push(scratch.origin[pixel]);
  }
  for (std::size_t end = 0; end < 2; ++end) {
    RayBeam& beam = scratch.beams[end];
    if (beam.count == 0) continue;
    technique_.occlude(beam, scratch.tile);
    const Vec3f color = ambient_light(directions[end]);
    for (std::uint32_t ray = 0; ray < beam.count; ++ray) {
      const std::size_t pixel = scratch.pixel_of_ray[end][ray];
      const float weight = scratch.weight_of_ray[end][ray];
      scratch.weight[pixel] += weight;
      if (!beam.is_occluded(ray)) add_light(light, pixel, color * weight);
    }
  }
  return scratch.beams[0].count + scratch.beams[1].count;
}

std::uint64_t Lighting::add_key_light(const LitTile& tile, Scratch& scratch,
                                      LightTile& light) const {
  static const std::array<std::uint8_t, kTilePixels> order = pixel_order<1>();
  RayBeam& beam = scratch.beams[0];
  beam.clear(make_beam_basis(to_key_, center_, scale_));
  for (const std::uint8_t pixel : order) {
    if (!scratch.is_lit[pixel]) continue;
    const Vec3f normal = normal_of(tile, pixel), face = scratch.face_normal[pixel];
    const float smooth = dot(normal, to_key_), flat = dot(face, to_key_);
    if (!(smooth > 0) || !(flat > 0)) continue;
    scratch.pixel_of_ray[0][beam.count] = pixel;
    scratch.weight_of_ray[0][beam.count] =
        smooth * softened_terminator(flat, smooth, dot(normal, face));
    beam.push(scratch.origin[pixel]);
  }
  if (beam.count == 0) return 0;
  technique_.occlude(beam, scratch.tile);
  for (std::uint32_t ray = 0; ray < beam.count; ++ray)
    if (!beam.is_occluded(ray))
      add_light(light, scratch.pixel_of_ray[0][ray], kKeyLight * scratch.weight_of_ray[0][ray]);
  return beam.count;
}

}  // namespace mdk
