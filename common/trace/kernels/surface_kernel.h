// What the pixels of a tile see of the surface they hit: where on the triangle, which way it faces
// and how it is painted.
#pragma once

#include <cstdint>

#include "common/motion/pose_sequence.h"
#include "common/trace/camera.h"
#include "common/trace/hit_buffer.h"

namespace mdk {

/// A corner of triangles that are seen; what shading needs of it lies together.
struct alignas(32) SurfaceVertex {
  Vec3f position;  ///< in the current pose
  float unused0 = 0;
  Vec3f normal;  ///< unit, or zero where there is none
  float unused1 = 0;
};
static_assert(sizeof(SurfaceVertex) == 8 * sizeof(float));

/// The mesh as shading sees it. A triangle's colour is that of the palette, times the colours of
/// its corners where there are any.
struct ShadedMesh {
  const Triangle* triangles;
  const SurfaceVertex* vertices;       ///< those of hit triangles suffice
  const std::uint8_t* is_flat;         ///< per triangle: shown with its own normal
  const Vec3f* palette;                ///< linear RGB
  const std::uint32_t* palette_index;  ///< per triangle
  const std::uint32_t* corner_colors;  ///< 3 per triangle, linear RGBA bytes, red lowest; or null
};

/// What is computed of a surface besides its colour.
struct SurfaceOptions {
  bool facing = true, normals = false, barycentrics = false;
};
/// One value per pixel of a tile, at j * kTileSide + i; without meaning where nothing was hit or it
/// was not asked for.
struct alignas(64) SurfaceTile {
  float normal_x[kTilePixels], normal_y[kTilePixels], normal_z[kTilePixels];  ///< unit, to the eye
  float facing[kTilePixels];  ///< cosine between normal and the way to the eye, in [0, 1]
  float bary1[kTilePixels], bary2[kTilePixels];  ///< barycentric coordinates of corners 1 and 2
  float red[kTilePixels], green[kTilePixels], blue[kTilePixels];  ///< linear
};

/// The upper left pixel of `hits`, which holds a hit, is (x, y) of the image. The same to the bit
/// on every machine.
void compute_surface(const PinholeRays& rays, std::uint32_t x, std::uint32_t y,
                     const ShadedMesh& mesh, const TileHits& hits, const SurfaceOptions& options,
                     SurfaceTile& surface);

}  // namespace mdk
