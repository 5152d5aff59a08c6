// What the kernels trace in one frame: the current triangles, and a structure of one or two levels
// over them, each tree in a basis of its own. A structure only chooses which triangles are tested.
#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "common/math/affine3.h"
#include "common/motion/posed_mesh.h"
#include "common/structures/kd_tree.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/kernels/ray_bounds.h"
#include "common/trace/kernels/triangle_block.h"

namespace mdk {

/// A hierarchy; its leaf i is block `first_leaf` + i.
struct BvhView {
  std::span<const WideBvhNode> nodes;
  std::uint32_t first_leaf = 0;
};

/// A tree, and what bounds the frame's rays in its basis.
template <class Tree>
struct TreeLevel {
  Tree tree;
  FrustumForms forms;  ///< of tiles
  Affine3d local_from_world;
  BeamSpace space;  ///< of beams
};

/// With clusters, the leaves of `top` hold clusters, else triangles. A hierarchy holds one cluster
/// a leaf; what a kd-tree refers to may stand in several leaves.
template <class Tree>
struct Levels {
  TreeLevel<Tree> top{};
  std::vector<TreeLevel<Tree>> clusters;
  std::span<const std::uint32_t> cluster_of_leaf;  ///< of a hierarchy
};
using BvhLevels = Levels<BvhView>;
using KdLevels = Levels<KdTreeView>;

struct TraceScene {
  const Triangle* triangles = nullptr;
  std::uint32_t triangle_count = 0;
  const Vec3f* positions = nullptr;
  const PosedMesh* mesh = nullptr;        ///< clusters are posed when a tile first enters them
  std::span<const TriangleBlock> blocks;  ///< of all leaves of hierarchies
  /// What this frame has made of the blocks; null: made anew for every tile or beam.
  ProjectionCache* projected_blocks = nullptr;
  PosedBlockCache* posed_blocks = nullptr;
  std::variant<std::monostate, BvhLevels, KdLevels> structure;  ///< none: all are tested
};

}  // namespace mdk
