// Small files of formats that Assimp reads, written out: a bar of two squares that bends.
#pragma once

#include <string>

namespace mdk::test {

struct ColladaOptions {
  std::string up_axis = "Y_UP";
  std::string metres = "1";  ///< what its unit is
  std::string image = "";    ///< name of a texture; empty: the colour 0.5, 0, 1
};

/// Corners (0|1, 0), (0|1, 1), (0|1, 2) in the plane z = 0, of which those at y = 1 hang half on
/// either bone. "Knee", at (0, 1, 0), turns about z: 0, 45 and 90 degrees at 0, 0.5 and 1 s.
std::string bending_collada(const ColladaOptions& options = {});

/// The same bar, and its motion, which stands in a file of its own (2 frames a second, z up).
std::string bending_md5mesh();
std::string bending_md5anim();

/// Bones without a mesh, in a second: "Hips" moves from (0, 0, 0) to (2, 0, 0), "Knee", 2 above it,
/// turns about z by 90 degrees, and ends 1 above that.
std::string bending_bvh();

/// A triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) that moves to (2, 3, 4) in 4800 ticks; left-handed.
std::string moving_x();

/// A triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) in centimetres that turns about z by `degrees` in a
/// second, about the pivot (1, 0, 0), and then by 90 degrees about z. `up_axis`: 1 for y, 2 for z.
std::string turning_fbx(double degrees, int up_axis = 1);

}  // namespace mdk::test
