// Animated meshes for tests: small, made on the spot, each hard in a way of its own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/isa.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/pipeline.h"

namespace mdk::test {

struct NamedSequence {
  std::string name;
  PoseSequence sequence;
};

/// A tube of rings that bends, twists and swells: `segments` x `around` quads, closed ends.
PoseSequence bending_tube(std::uint32_t segments, std::uint32_t around, std::uint32_t keys);

/// A closed ball of 8 * 4^`levels` triangles that twists about the y axis.
PoseSequence twisting_sphere(int levels, std::uint32_t keys);

/// Free triangles of all shapes, slivers, points and duplicates among them, each on a path of its
/// own; everything is scaled by `size` and moved by `offset` along x.
PoseSequence random_triangles(std::uint32_t count, std::uint32_t keys, float size, float offset);

/// Small triangles in the plane x = 0 but for 1e-7: seen along the plane their edge functions are
/// nothing but rounding.
PoseSequence edge_on_sheet(std::uint32_t count, std::uint32_t keys);

/// Boxes that fly apart and tumble.
PoseSequence flying_boxes(std::uint32_t count, std::uint32_t keys);

/// All of the above and degenerate ones: a flat sheet, one triangle, one key, a mesh that collapses
/// to a point, coordinates far from the origin and tiny ones.
std::vector<NamedSequence> agreement_scenes();

/// Decomposed with the default options.
DecomposeResult bake(PoseSequence sequence);

/// Any instruction set is allowed again at the end of a test.
class ResetIsa {
 public:
  ~ResetIsa() { reset_isa(); }
};

}  // namespace mdk::test
