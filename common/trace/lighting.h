// Lighting: the light that reaches what a tile shows. A distant key light casts shadows; a sky
// above and a ground below are seen through rays spread over the hemisphere (ambient occlusion).
// All rays of one direction in a tile make a beam (ray_beam.h), so directions are few: neighbouring
// pixels take turns with sets of their own (interleaved sampling, Keller and Heidrich 2001).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/aabb.h"
#include "common/trace/camera.h"
#include "common/trace/kernels/surface_kernel.h"
#include "common/trace/technique.h"

namespace mdk {

/// How many occlusion rays a sample may have, and has unless it is told otherwise.
inline constexpr std::uint32_t kMaxOcclusionRays = 1024;
inline constexpr std::uint32_t kOcclusionRays = 16;

/// One tile to be lit; the arrays have one value per pixel.
struct LitTile {
  const ShadedMesh& mesh;
  const TileHits& hits;
  const SurfaceTile& surface;
  std::uint32_t columns, rows;  ///< inside the image
};

/// Linear light per pixel, to be multiplied with its colour; of no meaning where nothing was hit.
struct alignas(64) LightTile {
  float red[kTilePixels], green[kTilePixels], blue[kTilePixels];
};

class Lighting {
 public:
  /// What a thread keeps between tiles.
  struct Scratch;

  /// Lights stand still in the picture: the key light above and left of the eye. `mesh` holds all
  /// of the mesh. `technique` must be ready to occlude, and outlive this.
  Lighting(const Technique& technique, const PinholeRays& rays, const Aabb& mesh);

  /// To be called before tiles are lit. `occlusion_rays` per pixel, up to kMaxOcclusionRays; 0:
  /// nothing hides sky and ground. `sample` numbers the pictures that are averaged, each of which
  /// has directions of its own.
  void choose_directions(std::uint32_t occlusion_rays, std::uint32_t sample);

  /// The same to the bit with all techniques but peers, and on every machine. Returns how many rays
  /// were traced. Safe from many threads at once.
  std::uint64_t light_tile(const LitTile& tile, Scratch& scratch, LightTile& light) const;

 private:
  Vec3f ambient_light(const Vec3f& direction) const;
  void find_origins(const LitTile& tile, Scratch& scratch) const;
  void add_open_sky(const LitTile& tile, const Scratch& scratch, LightTile& light) const;
  std::uint64_t add_sky(const LitTile& tile, Scratch& scratch, LightTile& light) const;
  std::uint64_t look_along(const Vec3f& axis, std::span<const std::uint8_t> pixels,
                           const LitTile& tile, Scratch& scratch, LightTile& light) const;
  std::uint64_t add_key_light(const LitTile& tile, Scratch& scratch, LightTile& light) const;

  const Technique& technique_;
  Vec3f center_;  ///< of the mesh: points count from here
  Vec3f eye_, right_, up_;
  float scale_ = 1;     ///< brings the mesh near 1, by a power of two
  float step_off_ = 0;  ///< how far above the surface rays start
  Vec3f to_key_;
  std::vector<Vec3f> axes_;  ///< of the first class of pixels, then of the second, ...
  std::size_t axes_per_class_ = 0;
};

struct Lighting::Scratch {
  TileScratch tile;
  RayBeam beams[2];
  std::uint8_t pixel_of_ray[2][kTilePixels];
  float weight_of_ray[2][kTilePixels];
  bool is_lit[kTilePixels];  ///< hit, and inside the image
  Vec3f origin[kTilePixels], face_normal[kTilePixels];
  float weight[kTilePixels];  ///< of all directions looked in
};

}  // namespace mdk
