#include "formats/gltf/links.h"

#include <string>

#include "common/base/error.h"

namespace mdk::gltf {
namespace {

void check_skin(const Document& document, std::size_t s) {
  const Skin& skin = document.skins[s];
  if (skin.inverse_bind_matrices == kNone) return;
  const Accessor& a = entry(document.accessors, skin.inverse_bind_matrices);
  if (a.components != 16 || a.type != ComponentType::kFloat32)
    fail(document, "skin", s, "has inverse bind matrices that are not 4x4 floats");
  if (a.count < skin.joints.size())
    fail(document, "skin", s, "has fewer inverse bind matrices than joints");
}

void check_mesh(const Document& document, std::size_t m) {
  const Mesh& mesh = document.meshes[m];
  for (const Primitive& primitive : mesh.primitives)
    if (primitive.target_offsets.size() != mesh.weights.size())
      fail(document, "mesh", m, "has primitives or weights that differ in morph targets");
}

void check_node(const Document& document, std::size_t n) {
  const Node& node = document.nodes[n];
  if (node.mesh == kNone) return;
  const Mesh& mesh = entry(document.meshes, node.mesh);
  if (node.weights.size() != mesh.weights.size())
    fail(document, "node", n, "has more or fewer weights than its mesh has morph targets");
}

void check_animation(const Document& document, std::size_t a) {
  for (const Channel& channel : document.animations[a].channels) {
    const Node& node = entry(document.nodes, channel.node);
    if (node.has_matrix && channel.path != TrackPath::kWeights)
      fail(document, "animation", a,
           "moves node " + std::to_string(channel.node) +
               ", which has a matrix; export it with translation, rotation and scale");
  }
}

}  // namespace

void order_nodes(Document& document) {
  std::vector<Node>& nodes = document.nodes;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    for (int child : nodes[n].children) {
      int& parent = entry(nodes, child).parent;
      if (parent != kNone)
        fail(document, "node", static_cast<std::size_t>(child), "has two parents");
      parent = static_cast<int>(n);
    }
  }
  std::vector<int>& order = document.node_order;
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (nodes[n].parent == kNone) order.push_back(static_cast<int>(n));
  for (std::size_t next = 0; next < order.size(); ++next)
    for (int child : entry(nodes, order[next]).children) order.push_back(child);
  // With one parent each, what no root leads to is a ring or hangs on one.
  if (order.size() != nodes.size())
    throw bad_input(document.path, "the nodes form a ring: one is its own ancestor");
}

void find_visible_nodes(Document& document, const std::vector<int>& roots) {
  std::vector<char> visible(document.nodes.size(), 0);
  for (int root : roots) entry(visible, root) = 1;
  for (int n : document.node_order) {
    const int parent = entry(document.nodes, n).parent;
    if (parent != kNone && entry(visible, parent)) entry(visible, n) = 1;
  }
  for (std::size_t n = 0; n < document.nodes.size(); ++n)
    if (visible[n] && document.nodes[n].mesh != kNone)
      document.visible_nodes.push_back(static_cast<int>(n));
}

void check_links(const Document& document) {
  for (std::size_t s = 0; s < document.skins.size(); ++s) check_skin(document, s);
  for (std::size_t m = 0; m < document.meshes.size(); ++m) check_mesh(document, m);
  for (std::size_t n = 0; n < document.nodes.size(); ++n) check_node(document, n);
  for (std::size_t a = 0; a < document.animations.size(); ++a) check_animation(document, a);
}

}  // namespace mdk::gltf
