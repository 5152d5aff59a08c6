#include "tests/formats/compressed_gltf.h"

#include <stdexcept>

#ifdef MDK_HAVE_MESHOPT
#include <meshoptimizer.h>
#endif
#ifdef MDK_HAVE_DRACO
#include <draco/compression/encode.h>
#endif

namespace mdk::test {

Grid::Grid(int n) {
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const float height = 0.25f * static_cast<float>((x * x + 3 * y) % 7);
      for (const float c : {static_cast<float>(x), static_cast<float>(y), height})
        positions.push_back(c);
    }
  for (int y = 0; y + 1 < n; ++y)
    for (int x = 0; x + 1 < n; ++x)
      for (const int corner : {0, 1, n, n, 1, n + 1})
        indices.push_back(static_cast<std::uint32_t>(y * n + x + corner));
}

#ifdef MDK_HAVE_MESHOPT

Code vertex_code(const void* data, std::size_t count, std::size_t stride) {
  Code code(meshopt_encodeVertexBufferBound(count, stride));
  code.resize(meshopt_encodeVertexBuffer(code.data(), code.size(), data, count, stride));
  return code;
}

Code triangle_code(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  Code code(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  code.resize(meshopt_encodeIndexBuffer(code.data(), code.size(), indices.data(), indices.size()));
  return code;
}

Code index_code(const std::vector<std::uint32_t>& indices, std::size_t vertices) {
  Code code(meshopt_encodeIndexSequenceBound(indices.size(), vertices));
  code.resize(
      meshopt_encodeIndexSequence(code.data(), code.size(), indices.data(), indices.size()));
  return code;
}

int MeshoptFile::add(const Code& code, std::size_t count, std::size_t stride,
                     const std::string& mode, const std::string& accessor) {
  const int plain = b.view(code);
  const std::string& range = b.at("bufferViews", plain);
  const std::string data = range.substr(1, range.size() - 2);
  const std::string bytes = std::to_string(count * stride);
  b.at("bufferViews", plain) = "{\"buffer\": 1, \"byteOffset\": " + std::to_string(stands_) +
                               ", \"byteLength\": " + bytes +
                               ", \"extensions\": {\"EXT_meshopt_compression\": {" + data +
                               ", \"byteStride\": " + std::to_string(stride) +
                               ", \"count\": " + std::to_string(count) + ", " + mode + "}}}";
  stands_ += count * stride;
  return b.add("accessors", "{\"bufferView\": " + std::to_string(plain) +
                                ", \"count\": " + std::to_string(count) + ", " + accessor + "}");
}

std::string MeshoptFile::fallback(const std::string& uri) const {
  return "{\"byteLength\": " + std::to_string(stands_) + uri +
         ", \"extensions\": {\"EXT_meshopt_compression\": {\"fallback\": true}}}";
}

std::string MeshoptFile::json() const {
  GltfBuilder whole = b;
  whole.set("extensionsRequired", "[\"EXT_meshopt_compression\"]");
  whole.add("buffers", "{\"byteLength\": " + std::to_string(b.bytes().size()) +
                           ", \"uri\": \"data:application/octet-stream;base64," +
                           base64(b.bytes()) + "\"}");
  whole.add("buffers", fallback(""));
  return whole.json();
}

std::string MeshoptFile::glb() const {
  GltfBuilder whole = b;
  whole.add("buffers", "{\"byteLength\": " + std::to_string(b.bytes().size()) + "}");
  whole.add("buffers", fallback(", \"uri\": \"none.bin\""));
  return whole.glb();
}

PoseSequence MeshoptFile::read_text(const std::string& json) {
  const TempFolder folder;
  return read_file(write_text(folder, "packed.gltf", json)).sequence;
}

MeshoptFile packed(const Grid& grid) {
  MeshoptFile file;
  const int positions = file.add(vertex_code(grid.positions.data(), grid.vertices(), 12),
                                 grid.vertices(), 12, kAttributes, kVec3);
  const int indices = file.add(triangle_code(grid.indices, grid.vertices()), grid.indices.size(), 4,
                               kTriangles, kIndex);
  file.b.mesh("\"POSITION\": " + std::to_string(positions),
              ", \"indices\": " + std::to_string(indices));
  file.b.add("nodes", "{\"mesh\": 0}");
  return file;
}

#endif  // MDK_HAVE_MESHOPT

#ifdef MDK_HAVE_DRACO

std::string draco_code(const Grid& grid, DracoMethod method) {
  draco::Mesh mesh;
  mesh.set_num_points(static_cast<std::uint32_t>(grid.vertices()));
  draco::GeometryAttribute position;
  position.Init(draco::GeometryAttribute::POSITION, nullptr, 3, draco::DT_FLOAT32, false, 12, 0);
  const int id = mesh.AddAttribute(position, true, mesh.num_points());
  for (std::uint32_t i = 0; i < mesh.num_points(); ++i)
    mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), &grid.positions[3 * i]);
  for (std::size_t i = 0; i < grid.indices.size(); i += 3)
    mesh.AddFace({draco::PointIndex(grid.indices[i]), draco::PointIndex(grid.indices[i + 1]),
                  draco::PointIndex(grid.indices[i + 2])});
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method == DracoMethod::kSequential ? draco::MESH_SEQUENTIAL_ENCODING
                                                               : draco::MESH_EDGEBREAKER_ENCODING);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  draco::EncoderBuffer buffer;
  if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok())
    throw std::runtime_error("Draco cannot encode the grid");
  return {buffer.data(), buffer.size()};
}

GltfBuilder draco_file(const Grid& grid, const std::string& code) {
  GltfBuilder b;
  const int view = b.view(std::vector<unsigned char>(code.begin(), code.end()));
  const std::string positions = "{\"componentType\": 5126, \"type\": \"VEC3\", \"count\": ";
  b.add("accessors", positions + std::to_string(grid.vertices()) + "}");
  b.add("accessors", "{\"componentType\": 5125, \"type\": \"SCALAR\", \"count\": " +
                         std::to_string(grid.indices.size()) + "}");
  b.mesh("\"POSITION\": 0",
         ", \"indices\": 1, \"extensions\": {\"KHR_draco_mesh_compression\": "
         "{\"bufferView\": " +
             std::to_string(view) + ", \"attributes\": {\"POSITION\": 0}}}");
  b.add("nodes", "{\"mesh\": 0}");
  b.set("extensionsRequired", "[\"KHR_draco_mesh_compression\"]");
  return b;
}

#endif  // MDK_HAVE_DRACO

}  // namespace mdk::test
