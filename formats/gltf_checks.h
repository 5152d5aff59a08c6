// Checks of a document that need more than one of its parts.
#pragma once

#include <vector>

#include "formats/gltf_document.h"

namespace mdk::gltf {

/// Sets every node's parent and `node_order`. `children`: per node. Throws Error (kBadInput) where
/// a node has two parents or the nodes form a ring. No recursion.
void order_nodes(Document& document, const std::vector<std::vector<int>>& children);

/// Sets `visible_nodes` to the nodes with a mesh at or below `roots`.
void find_visible_nodes(Document& document, const std::vector<int>& roots);

/// Throws Error (kBadInput) where skins, morph weights or animated nodes contradict one another.
void check_links(const Document& document);

}  // namespace mdk::gltf
