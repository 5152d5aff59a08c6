// What the parts of a document say of one another: the tree of nodes, and whether skins, morph
// weights and animations fit together.
#pragma once

#include <vector>

#include "formats/gltf/document.h"

namespace mdk::gltf {

/// Sets every node's parent and `node_order`. No recursion. Throws Error (kBadInput) where nodes
/// form no trees.
void order_nodes(Document& document);

/// Sets `visible_nodes`: those with a mesh, from `roots` down. The nodes are ordered.
void find_visible_nodes(Document& document, const std::vector<int>& roots);

/// Throws Error (kBadInput) where skins, morph weights or animated nodes contradict one another.
void check_links(const Document& document);

}  // namespace mdk::gltf
