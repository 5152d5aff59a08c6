// A sample whose motion is not a skin's: its vertices key by key, and how it is written.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "assets/distance_field.h"
#include "assets/surface_mesher.h"

namespace mdk {

using ByteColor = std::array<std::uint8_t, 3>;  ///< sRGB

struct SampleSequence {
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< counter-clockwise from outside
  std::vector<ByteColor> colors;                        ///< one per vertex
  std::vector<std::vector<Vec3d>> poses;                ///< per key, one position per vertex
};

/// A solid and how finely it is meshed.
struct SampleSolid {
  DistanceField field;
  DistanceField seam;  ///< zero where colours meet; may be empty
  Aabbd box;
  double grid_cell = 0;
  std::function<double(const Vec3d&)> edge_length;
};

/// The solid's surface in even triangles.
TriangleMesh mesh_solid(const SampleSolid& solid);

/// The first key as a Wavefront file with vertex colours.
std::vector<std::uint8_t> encode_obj(const SampleSequence& sequence);

/// All keys as a point cache, version 1. Positions are rounded to a micrometre.
std::vector<std::uint8_t> encode_pc2(const SampleSequence& sequence);

}  // namespace mdk
