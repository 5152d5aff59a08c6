// How loose the fuzzy boxes of a model are: their area in the world beside that of tight ones.
#pragma once

#include "common/motion/model.h"

namespace mdk {

/// Sums over all triangles in units of the area of the mesh's box at the same key; medians over
/// keys. 0 for a mesh without extent.
struct BoxAreas {
  double fuzzy = 0;  ///< of the fuzzy boxes that hold at the key, mapped back into the world
  double tight = 0;  ///< of the boxes of the triangles as they stand at the key: the floor
};

/// Cost: O(keys * triangles).
BoxAreas measure_box_areas(const Model& model);

}  // namespace mdk
