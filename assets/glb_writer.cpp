// One buffer holds everything; each accessor has a buffer view of its own, aligned to four bytes.
#include "assets/glb_writer.h"

#include <bit>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "common/base/error.h"

namespace mdk {
namespace {

// Keeps members in the order they are set, so that a file reads from asset to scene.
using Json = nlohmann::ordered_json;

enum ComponentType {
  kUnsignedByte = 5121,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};
enum BufferTarget { kNoTarget = 0, kVertices = 34962, kIndices = 34963 };

float rounded(double v) {
  // + 0.0 turns -0 into 0.
  return static_cast<float>(std::nearbyint(v * 1e6) / 1e6 + 0.0);
}

class GlbEncoder {
 public:
  explicit GlbEncoder(const GlbScene& scene) : scene_(scene) {}

  std::vector<std::uint8_t> encode() {
    json_["asset"] = {{"version", "2.0"}, {"generator", "mdk assets"}};
    if (!scene_.copyright.empty()) json_["asset"]["copyright"] = scene_.copyright;
    json_["scene"] = 0;
    json_["scenes"] = Json::array({{{"nodes", Json::array()}}});
    for (const GlbNode& node : scene_.nodes) add_node(node);
    for (const GlbMesh& mesh : scene_.meshes) add_mesh(mesh);
    for (const GlbSkin& skin : scene_.skins) add_skin(skin);
    for (const GlbClip& clip : scene_.clips) add_clip(clip);
    json_["buffers"] = Json::array({{{"byteLength", buffer_.size()}}});
    return container();
  }

 private:
  void add_node(const GlbNode& node) {
    const std::size_t index = json_["nodes"].size();
    Json out;
    out["name"] = node.name;
    if (length(node.translation) > 0) {
      const Vec3d& t = node.translation;
      out["translation"] = {rounded(t.x), rounded(t.y), rounded(t.z)};
    }
    const Quaternion& q = node.rotation;
    if (q.w != 1) out["rotation"] = {rounded(q.x), rounded(q.y), rounded(q.z), rounded(q.w)};
    if (node.mesh >= 0) out["mesh"] = node.mesh;
    if (node.skin >= 0) out["skin"] = node.skin;
    json_["nodes"].push_back(std::move(out));
    Json& parent = node.parent < 0
                       ? json_["scenes"][0]["nodes"]
                       : json_["nodes"][static_cast<std::size_t>(node.parent)]["children"];
    parent.push_back(index);
  }

  void add_mesh(const GlbMesh& mesh) {
    Json material;
    material["name"] = mesh.name;
    material["pbrMetallicRoughness"] = {{"baseColorFactor", {1, 1, 1, 1}},
                                        {"metallicFactor", 0},
                                        {"roughnessFactor", mesh.roughness}};
    Json attributes;
    attributes["POSITION"] = add_vectors(mesh.positions, kVertices);
    add_bounds(mesh.positions);
    attributes["NORMAL"] = add_vectors(mesh.normals, kVertices);
    attributes["COLOR_0"] = add_accessor(mesh.colors, kUnsignedByte, "VEC4", kVertices);
    json_["accessors"].back()["normalized"] = true;
    if (!mesh.joints.empty()) {
      attributes["JOINTS_0"] = add_accessor(mesh.joints, kUnsignedByte, "VEC4", kVertices);
      attributes["WEIGHTS_0"] = add_accessor(mesh.weights, kUnsignedShort, "VEC4", kVertices);
      json_["accessors"].back()["normalized"] = true;
    }
    Json primitive;
    primitive["attributes"] = std::move(attributes);
    primitive["indices"] = add_triangles(mesh);
    primitive["material"] = json_["materials"].size();
    json_["materials"].push_back(std::move(material));
    json_["meshes"].push_back({{"name", mesh.name}, {"primitives", Json::array({primitive})}});
  }

  std::size_t add_triangles(const GlbMesh& mesh) {
    if (mesh.positions.size() > 0xffff)
      return add_accessor(mesh.triangles, kUnsignedInt, "SCALAR", kIndices);
    std::vector<std::array<std::uint16_t, 3>> narrow;
    for (const auto& [a, b, c] : mesh.triangles)
      narrow.push_back({static_cast<std::uint16_t>(a), static_cast<std::uint16_t>(b),
                        static_cast<std::uint16_t>(c)});
    return add_accessor(narrow, kUnsignedShort, "SCALAR", kIndices);
  }

  void add_skin(const GlbSkin& skin) {
    std::vector<std::array<float, 16>> matrices;
    for (const auto& matrix : skin.inverse_bind_matrices) {
      auto& out = matrices.emplace_back();
      for (std::size_t i = 0; i < 16; ++i) out[i] = rounded(matrix[i]);
    }
    Json out;
    out["skeleton"] = skin.joints.front();
    out["joints"] = skin.joints;
    out["inverseBindMatrices"] = add_accessor(matrices, kFloat, "MAT4", kNoTarget);
    json_["skins"].push_back(std::move(out));
  }

  void add_clip(const GlbClip& clip) {
    Json out;
    out["name"] = clip.name;
    out["samplers"] = Json::array();
    out["channels"] = Json::array();
    std::vector<std::array<float, 1>> times;
    for (const double t : clip.times) times.push_back({static_cast<float>(t)});
    const std::size_t input = add_accessor(times, kFloat, "SCALAR", kNoTarget);
    json_["accessors"].back()["min"] = {times.front()[0]};
    json_["accessors"].back()["max"] = {times.back()[0]};
    for (const GlbTrack& track : clip.tracks) {
      const char* path = track.path == GlbPath::kRotation      ? "rotation"
                         : track.path == GlbPath::kTranslation ? "translation"
                                                               : "scale";
      out["channels"].push_back({{"sampler", out["samplers"].size()},
                                 {"target", {{"node", track.node}, {"path", path}}}});
      out["samplers"].push_back(
          {{"input", input}, {"interpolation", "LINEAR"}, {"output", add_values(track)}});
    }
    json_["animations"].push_back(std::move(out));
  }

  std::size_t add_values(const GlbTrack& track) {
    if (track.path != GlbPath::kRotation) {
      std::vector<Vec3d> vectors;
      for (const auto& v : track.values) vectors.push_back({v[0], v[1], v[2]});
      return add_vectors(vectors, kNoTarget);
    }
    std::vector<std::array<float, 4>> rotations;
    for (const auto& v : track.values)
      rotations.push_back({rounded(v[0]), rounded(v[1]), rounded(v[2]), rounded(v[3])});
    return add_accessor(rotations, kFloat, "VEC4", kNoTarget);
  }

  std::size_t add_vectors(const std::vector<Vec3d>& vectors, BufferTarget target) {
    std::vector<std::array<float, 3>> narrow;
    for (const Vec3d& v : vectors) narrow.push_back({rounded(v.x), rounded(v.y), rounded(v.z)});
    return add_accessor(narrow, kFloat, "VEC3", target);
  }

  /// The smallest and largest coordinates of what was added last, as the format demands.
  void add_bounds(const std::vector<Vec3d>& vectors) {
    Vec3f lo{rounded(vectors[0].x), rounded(vectors[0].y), rounded(vectors[0].z)}, hi = lo;
    for (const Vec3d& v : vectors)
      for (std::size_t a = 0; a < 3; ++a) {
        lo[a] = std::min(lo[a], rounded(v[a]));
        hi[a] = std::max(hi[a], rounded(v[a]));
      }
    json_["accessors"].back()["min"] = {lo.x, lo.y, lo.z};
    json_["accessors"].back()["max"] = {hi.x, hi.y, hi.z};
  }

  /// Appends the elements to the buffer and returns the accessor's index.
  template <class T, std::size_t N>
  std::size_t add_accessor(const std::vector<std::array<T, N>>& elements, ComponentType component,
                           const char* type, BufferTarget target) {
    while (buffer_.size() % 4 != 0) buffer_.push_back(0);
    const std::size_t offset = buffer_.size();
    for (const auto& element : elements)
      for (const T value : element) append_number(value, buffer_);
    Json view{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", buffer_.size() - offset}};
    if (target != kNoTarget) view["target"] = static_cast<int>(target);
    const bool scalar = type == std::string("SCALAR");
    Json accessor{{"bufferView", json_["bufferViews"].size()},
                  {"componentType", static_cast<int>(component)},
                  {"count", scalar ? elements.size() * N : elements.size()},
                  {"type", type}};
    json_["bufferViews"].push_back(std::move(view));
    json_["accessors"].push_back(std::move(accessor));
    return json_["accessors"].size() - 1;
  }

  /// Little-endian, whatever the machine.
  template <class T>
  static void append_number(T value, std::vector<std::uint8_t>& out) {
    if constexpr (std::is_same_v<T, float>) {
      append_number(std::bit_cast<std::uint32_t>(value), out);
    } else {
      for (std::size_t i = 0; i < sizeof(T); ++i)
        out.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i)));
    }
  }

  std::vector<std::uint8_t> container() {
    constexpr std::uint32_t kMagic = 0x46546c67, kVersion = 2;
    constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
    std::string text = json_.dump();
    while (text.size() % 4 != 0) text.push_back(' ');
    while (buffer_.size() % 4 != 0) buffer_.push_back(0);
    std::vector<std::uint8_t> file;
    append_number(kMagic, file);
    append_number(kVersion, file);
    append_number(static_cast<std::uint32_t>(28 + text.size() + buffer_.size()), file);
    append_number(static_cast<std::uint32_t>(text.size()), file);
    append_number(kJsonChunk, file);
    file.insert(file.end(), text.begin(), text.end());
    append_number(static_cast<std::uint32_t>(buffer_.size()), file);
    append_number(kBinaryChunk, file);
    file.insert(file.end(), buffer_.begin(), buffer_.end());
    return file;
  }

  const GlbScene& scene_;
  Json json_;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace

std::vector<std::uint8_t> encode_glb(const GlbScene& scene) { return GlbEncoder(scene).encode(); }

void write_bytes(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()),
            static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (!out) throw io_error(path, "cannot be written; check that its folder exists and has room");
}

}  // namespace mdk
