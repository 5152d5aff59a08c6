#include "tests/commands/sample_mesh.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using Json = nlohmann::json;

constexpr int kFloat = 5126, kUint32 = 5125, kUint16 = 5123;

/// Collects accessors, each with a buffer view of its own.
class GltfBuffer {
 public:
  /// Returns the accessor's number. `floats`: count * width numbers.
  int add_floats(const std::vector<float>& values, int width, const char* type) {
    Json accessor = add(values.data(), values.size() * sizeof(float), kFloat, type);
    accessor["count"] = values.size() / width;
    if (std::strcmp(type, "VEC3") == 0 || std::strcmp(type, "SCALAR") == 0) {
      accessor["min"] = extreme(values, width, [](float a, float b) { return std::min(a, b); });
      accessor["max"] = extreme(values, width, [](float a, float b) { return std::max(a, b); });
    }
    accessors.push_back(accessor);
    return static_cast<int>(accessors.size()) - 1;
  }
  template <class T>
  int add_integers(const std::vector<T>& values, int component, int width, const char* type) {
    Json accessor = add(values.data(), values.size() * sizeof(T), component, type);
    accessor["count"] = values.size() / width;
    accessors.push_back(accessor);
    return static_cast<int>(accessors.size()) - 1;
  }

  Json accessors = Json::array(), views = Json::array();
  std::string bytes;

 private:
  template <class Pick>
  static Json extreme(const std::vector<float>& values, int width, const Pick& pick) {
    std::vector<float> found(values.begin(), values.begin() + width);
    for (std::size_t i = 0; i < values.size(); ++i)
      found[i % width] = pick(found[i % width], values[i]);
    return found;
  }
  Json add(const void* data, std::size_t size, int component, const char* type) {
    while (bytes.size() % 4 != 0) bytes += '\0';
    views.push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}});
    bytes.append(static_cast<const char*>(data), size);
    return {{"bufferView", views.size() - 1}, {"componentType", component}, {"type", type}};
  }
};

Json tube_mesh(GltfBuffer& buffer, const TubeShape& shape) {
  std::vector<float> positions, weights;
  std::vector<std::uint16_t> joints;
  for (int r = 0; r <= shape.rings; ++r)
    for (int s = 0; s < shape.sides; ++s) {
      const double angle = 2 * std::numbers::pi * s / shape.sides;
      const double y = 2.0 * r / shape.rings;
      for (const double v : {0.3 * std::cos(angle), y, 0.3 * std::sin(angle)})
        positions.push_back(static_cast<float>(v));
      const float upper = static_cast<float>(std::clamp((y - 0.7) / 0.6, 0.0, 1.0));
      for (const float w : {1 - upper, upper, 0.0f, 0.0f}) weights.push_back(w);
      for (const std::uint16_t j : {0, 1, 0, 0}) joints.push_back(j);
    }
  std::vector<std::uint32_t> indices;
  for (int r = 0; r < shape.rings; ++r)
    for (int s = 0; s < shape.sides; ++s) {
      const int a = r * shape.sides + s, b = r * shape.sides + (s + 1) % shape.sides;
      for (const int v : {a, a + shape.sides, b, b, a + shape.sides, b + shape.sides})
        indices.push_back(static_cast<std::uint32_t>(v));
    }
  const Json attributes = {{"POSITION", buffer.add_floats(positions, 3, "VEC3")},
                           {"WEIGHTS_0", buffer.add_floats(weights, 4, "VEC4")},
                           {"JOINTS_0", buffer.add_integers(joints, kUint16, 4, "VEC4")}};
  const int index = buffer.add_integers(indices, kUint32, 1, "SCALAR");
  return {{"primitives", {{{"attributes", attributes}, {"indices", index}, {"material", 0}}}}};
}

Json cube_mesh(GltfBuffer& buffer) {
  std::vector<float> positions;
  for (int i = 0; i < 8; ++i)
    for (int axis = 0; axis < 3; ++axis) positions.push_back((i >> axis & 1) != 0 ? 0.2f : -0.2f);
  const std::vector<std::uint32_t> indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                              2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  const Json attributes = {{"POSITION", buffer.add_floats(positions, 3, "VEC3")}};
  const int index = buffer.add_integers(indices, kUint32, 1, "SCALAR");
  return {{"primitives", {{{"attributes", attributes}, {"indices", index}, {"material", 1}}}}};
}

struct Swing {
  const char* name;
  int node;
  int axis;  ///< of the rotation: 1 about y, 2 about z
  float seconds;
  double degrees;
};

/// One node turned there and back about an axis.
Json animation(GltfBuffer& buffer, const Swing& swing) {
  const std::vector<float> times = {0, swing.seconds / 2, swing.seconds};
  std::vector<float> rotations;
  for (const double degrees : {0.0, swing.degrees, 0.0}) {
    const double half = degrees * std::numbers::pi / 360;
    float quaternion[4] = {0, 0, 0, static_cast<float>(std::cos(half))};
    quaternion[swing.axis] = static_cast<float>(std::sin(half));
    rotations.insert(rotations.end(), quaternion, quaternion + 4);
  }
  const int input = buffer.add_floats(times, 1, "SCALAR");
  const int output = buffer.add_floats(rotations, 4, "VEC4");
  return {
      {"name", swing.name},
      {"samplers", {{{"input", input}, {"output", output}}}},
      {"channels", {{{"sampler", 0}, {"target", {{"node", swing.node}, {"path", "rotation"}}}}}}};
}

Json material(float r, float g, float b) {
  return {{"pbrMetallicRoughness", {{"baseColorFactor", {r, g, b, 1.0f}}}}};
}

}  // namespace

void write_sample_gltf(const std::string& path, const TubeShape& shape) {
  GltfBuffer buffer;
  const Json meshes = {tube_mesh(buffer, shape), cube_mesh(buffer)};
  const std::vector<float> inverse_binds = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                            1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1};
  const Json skin = {{"joints", {1, 2}},
                     {"inverseBindMatrices", buffer.add_floats(inverse_binds, 16, "MAT4")}};
  const Json nodes = {{{"name", "tube"}, {"mesh", 0}, {"skin", 0}},
                      {{"name", "lower"}, {"children", {2}}},
                      {{"name", "upper"}, {"translation", {0, 1, 0}}},
                      {{"name", "pivot"}, {"children", {4}}},
                      {{"name", "cube"}, {"mesh", 1}, {"translation", {0.9, 1.0, 0.0}}}};
  const Json animations = {animation(buffer, {"bend", 2, 2, 1.0f, 80}),
                           animation(buffer, {"swing", 3, 1, 0.5f, 120})};
  std::filesystem::path bin = path;
  bin.replace_extension(".bin");
  std::string uri;
  for (const char c : bin.filename().string())
    uri += c == ' ' ? std::string("%20") : std::string(1, c);
  const Json gltf = {{"asset", {{"version", "2.0"}}},
                     {"scene", 0},
                     {"scenes", {{{"nodes", {0, 1, 3}}}}},
                     {"nodes", nodes},
                     {"meshes", meshes},
                     {"skins", {skin}},
                     {"materials", {material(0.9f, 0.5f, 0.2f), material(0.2f, 0.5f, 0.9f)}},
                     {"animations", animations},
                     {"accessors", buffer.accessors},
                     {"bufferViews", buffer.views},
                     {"buffers", {{{"uri", uri}, {"byteLength", buffer.bytes.size()}}}}};
  write_text(bin.string(), buffer.bytes);
  write_text(path, gltf.dump());
}

}  // namespace mdk::test
