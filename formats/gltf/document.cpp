// From bytes to a document: the properties are read first; then buffers, what is compressed in
// them, and what accessors and images point at.
#include "formats/gltf/document.h"

#include <map>
#include <utility>

#include "common/base/error.h"
#include "formats/gltf/compression.h"
#include "formats/gltf/properties.h"

namespace mdk::gltf {
namespace {

// An accessor without bytes is free to claim any length, so its length has a limit of its own.
constexpr std::size_t kMaxZeroElements = std::size_t{1} << 24;

/// Gives a document whose properties are read its bytes.
class BytesLoader {
 public:
  BytesLoader(const Properties& properties, Document& document, ReadResult& result)
      : properties_(properties), document_(document), result_(result) {}

  void load(std::span<const unsigned char> binary_chunk) {
    for (const BufferSource& buffer : properties_.buffers)
      document_.buffers.push_back(read_buffer(buffer, binary_chunk));
    for (const MeshoptView& view : properties_.meshopt_views) {
      document_.decoded.push_back(decode_meshopt(view, range_bytes(view.data)));
      if (document_.decoded.back().empty())
        fail(document_, "buffer view", view.view, "has broken meshopt data");
      decoded_views_[view.view] = document_.decoded.back();
    }
    for (std::size_t i = 0; i < document_.accessors.size(); ++i) find_elements(i);
    for (const DracoPrimitive& primitive : properties_.draco_primitives)
      decode_draco(primitive, range_bytes(primitive.data), document_);
    for (std::size_t i = 0; i < document_.images.size(); ++i) find_image(i);
    require_index_lists();
  }

 private:
  Bytes read_buffer(const BufferSource& buffer, std::span<const unsigned char> binary_chunk) {
    const std::size_t number = document_.buffers.size();
    if (buffer.is_empty) return {};
    if (buffer.uri.empty()) {
      if (buffer.bytes > binary_chunk.size())
        fail(document_, "buffer", number, "has no uri, and no binary chunk holds its bytes");
      return Bytes(binary_chunk.begin(),
                   binary_chunk.begin() + static_cast<std::ptrdiff_t>(buffer.bytes));
    }
    if (std::optional<Bytes> bytes = data_uri_bytes(buffer.uri)) {
      if (bytes->size() != buffer.bytes)
        fail(document_, "buffer", number, "has a data URI that does not decode to its byteLength");
      return std::move(*bytes);
    }
    const std::string file = resolve_uri(document_.path, buffer.uri);
    Bytes bytes = read_whole_file(file);
    result_.dependencies.push_back(file);
    if (bytes.size() < buffer.bytes)
      throw bad_input(file, "holds " + std::to_string(bytes.size()) + " bytes where " +
                                std::to_string(buffer.bytes) + " are needed; it may be cut short");
    bytes.resize(buffer.bytes);
    return bytes;
  }

  std::span<const unsigned char> range_bytes(const ByteRange& range) const {
    return std::span<const unsigned char>(document_.buffers[range.buffer])
        .subspan(range.offset, range.size);
  }

  std::span<const unsigned char> view_bytes(int view) const {
    const auto decoded = decoded_views_.find(static_cast<std::size_t>(view));
    if (decoded != decoded_views_.end()) return decoded->second;
    return range_bytes(entry(properties_.views, view).range);
  }

  void find_elements(std::size_t i) {
    const AccessorSource& source = properties_.accessors[i];
    Accessor& a = document_.accessors[i];
    const std::size_t element = a.element_bytes();
    a.stride = element;
    if (source.elements.view != kNone) {
      const std::span<const unsigned char> bytes = view_bytes(source.elements.view);
      const std::size_t offset = source.elements.offset;
      const std::size_t stride = entry(properties_.views, source.elements.view).stride;
      if (stride != 0) a.stride = stride;
      if (a.stride < element)
        fail(document_, "accessor", i, "has elements wider than their stride");
      if (offset > bytes.size() || element > bytes.size() - offset ||
          a.count - 1 > (bytes.size() - offset - element) / a.stride)
        fail(document_, "accessor", i, "reaches past its buffer view");
      a.data = bytes.data() + offset;
    } else if (a.count > kMaxZeroElements) {
      fail(document_, "accessor", i, "has no data for " + std::to_string(a.count) + " elements");
    }
    if (a.sparse_count == 0) return;
    a.sparse_indices = sparse_part(i, source.sparse_indices, component_bytes(a.sparse_index_type));
    a.sparse_values = sparse_part(i, source.sparse_values, element);
  }

  const unsigned char* sparse_part(std::size_t accessor, const ElementSource& source,
                                   std::size_t width) const {
    const std::span<const unsigned char> bytes = view_bytes(source.view);
    const std::size_t count = document_.accessors[accessor].sparse_count;
    if (source.offset > bytes.size() || count > (bytes.size() - source.offset) / width)
      fail(document_, "accessor", accessor, "has sparse data that reaches past its buffer view");
    return bytes.data() + source.offset;
  }

  void find_image(std::size_t i) {
    ImageSource& image = document_.images[i];
    if (properties_.image_views[i] != kNone) {
      image.bytes = view_bytes(properties_.image_views[i]);
    } else if (std::optional<Bytes> bytes = data_uri_bytes(image.uri)) {
      if (bytes->empty()) fail(document_, "image", i, "has a data URI that cannot be decoded");
      image.bytes = document_.decoded.emplace_back(std::move(*bytes));
    }
  }

  void require_index_lists() const {
    for (std::size_t m = 0; m < document_.meshes.size(); ++m)
      for (const Primitive& p : document_.meshes[m].primitives)
        if (p.indices != kNone && !entry(document_.accessors, p.indices).data)
          fail(document_, "mesh", m, "has an index list without data");
  }

  const Properties& properties_;
  Document& document_;
  ReadResult& result_;
  std::map<std::size_t, std::span<const unsigned char>> decoded_views_;
};

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

/// Sets every node's parent and `node_order`. No recursion.
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

/// The nodes with a mesh that `scene` shows; without a scene, all of them.
std::vector<int> visible_nodes(const Document& document,
                               const std::optional<std::vector<int>>& scene) {
  std::vector<char> visible(document.nodes.size(), scene ? 0 : 1);
  if (scene)
    for (int root : *scene) entry(visible, root) = 1;
  for (int n : document.node_order) {
    const int parent = entry(document.nodes, n).parent;
    if (parent != kNone && entry(visible, parent)) entry(visible, n) = 1;
  }
  std::vector<int> nodes;
  for (std::size_t n = 0; n < document.nodes.size(); ++n)
    if (visible[n] && document.nodes[n].mesh != kNone) nodes.push_back(static_cast<int>(n));
  return nodes;
}

/// Throws Error (kBadInput) where skins, morph weights or animated nodes contradict one another.
void check_links(const Document& document) {
  for (std::size_t s = 0; s < document.skins.size(); ++s) check_skin(document, s);
  for (std::size_t m = 0; m < document.meshes.size(); ++m) check_mesh(document, m);
  for (std::size_t n = 0; n < document.nodes.size(); ++n) check_node(document, n);
  for (std::size_t a = 0; a < document.animations.size(); ++a) check_animation(document, a);
}

}  // namespace

void fail(const Document& document, const char* what, std::size_t number,
          const std::string& sentence) {
  throw bad_input(document.path, what + (" " + std::to_string(number)) + " " + sentence);
}

Document parse_document(const std::string& path, const Bytes& bytes, ReadResult& result) {
  Document document;
  document.path = path;
  const FileParts parts = file_parts(path, bytes);
  const Properties properties = read_properties(parts.json, document, result);
  BytesLoader(properties, document, result).load(parts.binary);
  order_nodes(document);
  document.visible_nodes = visible_nodes(document, properties.scene);
  check_links(document);
  return document;
}

}  // namespace mdk::gltf
