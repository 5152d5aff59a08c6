// OverlaySettings: which boxes are drawn over the picture.
#pragma once

namespace mdk {

inline constexpr int kMostTreeDepth = 16;

struct OverlaySettings {
  bool world_boxes = false;  ///< of clusters, axis-aligned in the world
  bool local_boxes = false;  ///< of clusters, in their own bases
  bool tree_cells = false;   ///< of the fuzzy kd-trees
  int tree_depth = 4;        ///< cells at this depth, and leaves above it
  bool fuzzy_box = true;     ///< of the picked triangle
  bool local_basis = true;   ///< of its cluster
};

}  // namespace mdk
