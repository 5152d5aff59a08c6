#include "tests/formats/gltf_builder.h"

#include <cstring>
#include <filesystem>
#include <fstream>

#include "common/base/parallel.h"

namespace mdk::test {
namespace {

std::string u32(std::size_t value) {
  const auto v = static_cast<std::uint32_t>(value);
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &v, 4);
  return bytes;
}

}  // namespace

std::string base64(const std::string& bytes) {
  static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
  }
  return text;
}

int GltfBuilder::triangle_mesh() {
  return mesh("\"POSITION\": " +
              std::to_string(accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})));
}

int GltfBuilder::animation(int node, const std::string& path, int times, int values,
                           const std::string& interpolation) {
  return add("animations", "{\"samplers\": [{\"input\": " + std::to_string(times) +
                               ", \"output\": " + std::to_string(values) +
                               ", \"interpolation\": \"" + interpolation +
                               "\"}], \"channels\": [{\"sampler\": 0, \"target\": {\"node\": " +
                               std::to_string(node) + ", \"path\": \"" + path + "\"}}]}");
}

std::string GltfBuilder::json() const {
  return document(", \"uri\": \"data:application/octet-stream;base64," + base64(bytes_) + "\"");
}

std::string GltfBuilder::glb() const {
  std::string text = document(""), bin = bytes_;
  text.resize((text.size() + 3) / 4 * 4, ' ');
  bin.resize((bin.size() + 3) / 4 * 4);
  std::string file = "glTF" + u32(2) + u32(28 + text.size() + bin.size());
  file += u32(text.size()) + "JSON" + text;
  return file + u32(bin.size()) + std::string("BIN\0", 4) + bin;
}

std::string GltfBuilder::document(const std::string& buffer_uri) const {
  std::string text = "{\"asset\": {\"version\": \"2.0\"}";
  if (!bytes_.empty() && !lists_.contains("buffers"))
    text +=
        ",\n\"buffers\": [{\"byteLength\": " + std::to_string(bytes_.size()) + buffer_uri + "}]";
  for (const auto& [name, value] : members_) text += ",\n\"" + name + "\": " + value;
  for (const auto& [name, objects] : lists_) {
    text += ",\n\"" + name + "\": [";
    for (std::size_t i = 0; i < objects.size(); ++i) text += (i ? ", " : "") + objects[i];
    text += "]";
  }
  return text + "}";
}

std::string write_text(const TempFolder& folder, const std::string& name, const std::string& text) {
  const std::string path = folder.file(name);
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

ReadResult read_file(const std::string& path, double fps, const std::vector<std::string>& clips) {
  SilentProgress silent;
  return read_gltf(path, {.fps = fps, .clips = clips}, silent);
}

ReadResult read_built(const GltfBuilder& builder, const ReadOptions& options) {
  const TempFolder folder;
  SilentProgress silent;
  return read_gltf(write_text(folder, "test.gltf", builder.json()), options, silent);
}

ReadResult read_built(const GltfBuilder& builder, double fps,
                      const std::vector<std::string>& clips) {
  const TempFolder folder;
  return read_file(write_text(folder, "test.gltf", builder.json()), fps, clips);
}

}  // namespace mdk::test
