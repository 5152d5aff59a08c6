// GltfBuilder: writes small glTF files from a test, with their buffers inside as data URIs.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <type_traits>
#include <vector>

#include "formats/gltf/reader.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {

std::string base64(const std::string& bytes);

class GltfBuilder {
 public:
  /// Adds an object to a top-level list ("nodes"); returns its index.
  int add(const std::string& list, const std::string& json) {
    lists_[list].push_back(json);
    return static_cast<int>(lists_[list].size()) - 1;
  }
  std::string& at(const std::string& list, int index) {
    return lists_[list][static_cast<std::size_t>(index)];
  }
  /// Adds a member of the file itself ("extensionsRequired").
  void set(const std::string& name, const std::string& json) { members_[name] = json; }

  /// Adds a buffer view of the numbers; `more` is appended to its JSON (", \"byteStride\": 16").
  template <class T>
  int view(const std::vector<T>& numbers, const std::string& more = "") {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    const std::size_t offset = bytes_.size(), size = numbers.size() * sizeof(T);
    bytes_.append(reinterpret_cast<const char*>(numbers.data()), size);
    return add("bufferViews", "{\"buffer\": 0, \"byteOffset\": " + std::to_string(offset) +
                                  ", \"byteLength\": " + std::to_string(size) + more + "}");
  }

  /// Adds an accessor of tightly packed elements of a type ("VEC3").
  template <class T>
  int accessor(const std::string& type, const std::vector<T>& numbers,
               const std::string& more = "") {
    const std::size_t count = numbers.size() / components(type);
    return add("accessors", "{\"bufferView\": " + std::to_string(view(numbers)) +
                                ", \"componentType\": " + std::to_string(component_type<T>()) +
                                ", \"count\": " + std::to_string(count) + ", \"type\": \"" + type +
                                "\"" + more + "}");
  }

  /// A mesh of one primitive: attributes as JSON members ("\"POSITION\": 0").
  int mesh(const std::string& attributes, const std::string& more = "") {
    return add("meshes", "{\"primitives\": [{\"attributes\": {" + attributes + "}" + more + "}]}");
  }

  /// The triangle (0,0,0) (1,0,0) (0,1,0) without normals, as a mesh.
  int triangle_mesh();

  /// An animation of one channel.
  int animation(int node, const std::string& path, int times, int values,
                const std::string& interpolation = "LINEAR");

  std::string json() const;
  std::string glb() const;
  const std::string& bytes() const { return bytes_; }

 private:
  static std::size_t components(const std::string& type) {
    return type == "SCALAR" ? 1 : type == "MAT4" ? 16 : static_cast<std::size_t>(type[3] - '0');
  }
  template <class T>
  static int component_type() {
    if (std::is_same_v<T, float>) return 5126;
    const int base = sizeof(T) == 1 ? 5120 : sizeof(T) == 2 ? 5122 : 5124;
    return base + (std::is_unsigned_v<T> ? 1 : 0);
  }
  std::string document(const std::string& buffer_uri) const;

  std::map<std::string, std::vector<std::string>> lists_;
  std::map<std::string, std::string> members_;
  std::string bytes_;
};

/// Writes a text into a folder, making folders on the way; returns the path.
std::string write_text(const TempFolder& folder, const std::string& name, const std::string& text);

/// Reads a file at `fps`, all clips or those named.
ReadResult read_file(const std::string& path, double fps = 30,
                     const std::vector<std::string>& clips = {});

/// Writes what was built as "test.gltf" and reads it back.
ReadResult read_built(const GltfBuilder& builder, const ReadOptions& options);
ReadResult read_built(const GltfBuilder& builder, double fps = 30,
                      const std::vector<std::string>& clips = {});

}  // namespace mdk::test
