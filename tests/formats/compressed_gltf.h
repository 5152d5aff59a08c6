// Compressed glTF, made by the libraries that define the compressions, where these are there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/formats/gltf_builder.h"

namespace mdk::test {

/// A hilly grid of n x n vertices.
struct Grid {
  explicit Grid(int n);
  std::size_t vertices() const { return positions.size() / 3; }

  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
};

using Code = std::vector<unsigned char>;

inline const char* const kVec3 = "\"componentType\": 5126, \"type\": \"VEC3\"";
inline const char* const kIndex = "\"componentType\": 5125, \"type\": \"SCALAR\"";
inline const char* const kAttributes = "\"mode\": \"ATTRIBUTES\"";
inline const char* const kTriangles = "\"mode\": \"TRIANGLES\"";
inline const char* const kIndices = "\"mode\": \"INDICES\"";

#ifdef MDK_HAVE_MESHOPT

Code vertex_code(const void* data, std::size_t count, std::size_t stride);
Code triangle_code(const std::vector<std::uint32_t>& indices, std::size_t vertices);
Code index_code(const std::vector<std::uint32_t>& indices, std::size_t vertices);

/// A file whose views are compressed in buffer 0, and stand in buffer 1, which has no data.
class MeshoptFile {
 public:
  /// Adds a compressed view and an accessor over it; returns the accessor.
  int add(const Code& code, std::size_t count, std::size_t stride, const std::string& mode,
          const std::string& accessor);

  std::string json() const;
  /// Buffer 1 has a uri that leads nowhere.
  std::string glb() const;

  PoseSequence read() const { return read_text(json()); }
  static PoseSequence read_text(const std::string& json);

  GltfBuilder b;

 private:
  std::string fallback(const std::string& uri) const;

  std::size_t stands_ = 0;
};

/// The grid as one mesh of compressed positions and triangles.
MeshoptFile packed(const Grid& grid);

#endif

#ifdef MDK_HAVE_DRACO

enum class DracoMethod { kSequential, kEdgebreaker };

/// The grid as a Draco mesh: POSITION has the unique id 0.
std::string draco_code(const Grid& grid, DracoMethod method);

/// A file whose mesh the code is.
GltfBuilder draco_file(const Grid& grid, const std::string& code);

#endif

}  // namespace mdk::test
