// Compressed glTF, made here by the libraries that define the compressions.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "formats/gltf_draco.h"
#include "formats/gltf_meshopt.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/gltf_builder.h"

#ifdef MDK_HAVE_MESHOPT
#include <meshoptimizer.h>
#endif
#ifdef MDK_HAVE_DRACO
#include <draco/compression/encode.h>
#endif

namespace mdk::test {
namespace {

using testing::HasSubstr;

/// A hilly grid of n x n vertices.
struct Grid {
  explicit Grid(int n) {
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
  std::size_t vertices() const { return positions.size() / 3; }

  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
};

PoseSequence read_plain(const Grid& grid) {
  GltfBuilder b;
  const int positions = b.accessor("VEC3", grid.positions);
  const int indices = b.accessor("SCALAR", grid.indices);
  b.mesh("\"POSITION\": " + std::to_string(positions), ", \"indices\": " + std::to_string(indices));
  b.add("nodes", "{\"mesh\": 0}");
  return read_built(b).sequence;
}

/// Corner positions, each triangle turned so that its smallest corner comes first; sorted.
std::vector<std::vector<float>> turned_triangles(const PoseSequence& s) {
  std::vector<std::vector<float>> all;
  for (const Triangle& t : s.triangles) {
    std::vector<std::vector<float>> turns;
    for (int first = 0; first < 3; ++first) {
      turns.emplace_back();
      for (int c = 0; c < 3; ++c) {
        const Vec3f p = s.pose(0)[t.v[(first + c) % 3]];
        turns.back().insert(turns.back().end(), {p.x, p.y, p.z});
      }
    }
    all.push_back(*std::min_element(turns.begin(), turns.end()));
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// Reads what was built, which must give a mesh or one sentence.
void survive(const GltfBuilder& b) {
  try {
    check_consistency(read_built(b).sequence);
  } catch (const Error& error) {
    EXPECT_NE(error.code(), ErrorCode::kInternal) << error.what();
    EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
  }
}

#ifdef MDK_HAVE_MESHOPT

using Code = std::vector<unsigned char>;

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

/// A file whose views are compressed in buffer 0, and stand in buffer 1, which has no data.
class MeshoptFile {
 public:
  /// Adds a compressed view and an accessor over it; returns the accessor.
  int add(const Code& code, std::size_t count, std::size_t stride, const std::string& mode,
          const std::string& accessor) {
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

  std::string json() {
    b.set("extensionsRequired", "[\"EXT_meshopt_compression\"]");
    GltfBuilder whole = b;
    whole.add("buffers", "{\"byteLength\": " + std::to_string(b.bytes().size()) +
                             ", \"uri\": \"data:application/octet-stream;base64," +
                             base64(b.bytes()) + "\"}");
    whole.add("buffers", "{\"byteLength\": " + std::to_string(stands_) +
                             ", \"extensions\": {\"EXT_meshopt_compression\": "
                             "{\"fallback\": true}}}");
    return whole.json();
  }

  PoseSequence read() const { return read_text(MeshoptFile(*this).json()); }
  static PoseSequence read_text(const std::string& json) {
    const TempFolder folder;
    return read_file(write_text(folder, "packed.gltf", json)).sequence;
  }

  GltfBuilder b;

 private:
  std::size_t stands_ = 0;
};

const char* const kVec3 = "\"componentType\": 5126, \"type\": \"VEC3\"";
const char* const kIndex = "\"componentType\": 5125, \"type\": \"SCALAR\"";
const char* const kAttributes = "\"mode\": \"ATTRIBUTES\"";

MeshoptFile packed(const Grid& grid) {
  MeshoptFile file;
  const int positions = file.add(vertex_code(grid.positions.data(), grid.vertices(), 12),
                                 grid.vertices(), 12, kAttributes, kVec3);
  const int indices = file.add(triangle_code(grid.indices, grid.vertices()), grid.indices.size(), 4,
                               "\"mode\": \"TRIANGLES\"", kIndex);
  file.b.mesh("\"POSITION\": " + std::to_string(positions),
              ", \"indices\": " + std::to_string(indices));
  file.b.add("nodes", "{\"mesh\": 0}");
  return file;
}

TEST(GltfMeshopt, AttributesAndTrianglesAreThoseOfThePlainFile) {
  const Grid grid(24);
  EXPECT_EQ(turned_triangles(packed(grid).read()), turned_triangles(read_plain(grid)));
}

TEST(GltfMeshopt, IndexSequencesKeepTheirOrder) {
  const Grid grid(5);
  MeshoptFile file;
  file.add(vertex_code(grid.positions.data(), grid.vertices(), 12), grid.vertices(), 12,
           kAttributes, kVec3);
  file.add(index_code(grid.indices, grid.vertices()), grid.indices.size(), 4,
           "\"mode\": \"INDICES\"", kIndex);
  file.b.mesh("\"POSITION\": 0", ", \"indices\": 1");
  file.b.add("nodes", "{\"mesh\": 0}");
  EXPECT_EQ(file.read().triangles, read_plain(grid).triangles);
  EXPECT_EQ(file.read().positions, read_plain(grid).positions);
}

TEST(GltfMeshopt, ReadsBinaryFilesWithAFallbackThatIsNotThere) {
  const Grid grid(9);
  MeshoptFile file = packed(grid);
  // The text of a .glb: buffer 0 is the binary chunk, buffer 1 has a uri that leads nowhere.
  file.b.add("buffers", "{\"byteLength\": " + std::to_string(file.b.bytes().size()) + "}");
  file.b.add("buffers",
             "{\"byteLength\": 100000, \"uri\": \"none.bin\", \"extensions\": "
             "{\"EXT_meshopt_compression\": {\"fallback\": true}}}");
  const TempFolder folder;
  const ReadResult result = read_file(write_text(folder, "packed.glb", file.b.glb()));
  EXPECT_EQ(turned_triangles(result.sequence), turned_triangles(read_plain(grid)));
  EXPECT_THAT(result.dependencies, testing::SizeIs(1));
}

TEST(GltfMeshopt, FiltersAreUndone) {
  // Exponents: 2^E * M, here exact. Quaternions: a half turn about z, and one about x.
  const Grid grid(6);
  MeshoptFile file;
  std::vector<float> filtered(grid.positions.size());
  meshopt_encodeFilterExp(filtered.data(), grid.vertices(), 12, 23, grid.positions.data());
  file.add(vertex_code(filtered.data(), grid.vertices(), 12), grid.vertices(), 12,
           "\"mode\": \"ATTRIBUTES\", \"filter\": \"EXPONENTIAL\"", kVec3);
  file.add(index_code(grid.indices, grid.vertices()), grid.indices.size(), 4,
           "\"mode\": \"INDICES\"", kIndex);
  const std::vector<float> turns = {0, 0, 1, 0, 1, 0, 0, 0};
  std::vector<std::int16_t> turn_code(8);
  meshopt_encodeFilterQuat(turn_code.data(), 2, 8, 16, turns.data());
  const int values = file.add(vertex_code(turn_code.data(), 2, 8), 2, 8,
                              "\"mode\": \"ATTRIBUTES\", \"filter\": \"QUATERNION\"",
                              "\"componentType\": 5122, \"normalized\": true, \"type\": \"VEC4\"");
  const std::vector<float> seconds = {0, 1};
  const int times = file.add(vertex_code(seconds.data(), 2, 4), 2, 4, kAttributes,
                             "\"componentType\": 5126, \"type\": \"SCALAR\"");
  file.b.mesh("\"POSITION\": 0", ", \"indices\": 1");
  file.b.add("nodes", "{\"mesh\": 0}");
  file.b.animation(0, "rotation", times, values);
  const PoseSequence s = file.read(), plain = read_plain(grid);
  ASSERT_EQ(s.triangles, plain.triangles);
  for (std::uint32_t i = 0; i < s.vertex_count; ++i) {
    const Vec3f p = plain.pose(0)[i];
    EXPECT_LT(length(s.pose(0)[i] - Vec3f{-p.x, -p.y, p.z}), 1e-3f);
    EXPECT_LT(length(s.pose(s.key_count() - 1)[i] - Vec3f{p.x, -p.y, -p.z}), 1e-3f);
  }
}

TEST(GltfMeshopt, EveryPropertyThatIsWrongIsRefused) {
  const std::string good = packed(Grid(24)).json();
  struct Case {
    const char *from, *to, *words;
  };
  for (const Case& c : std::vector<Case>{
           {"\"mode\": \"ATTRIBUTES\"", "\"mode\": \"OTHER\"", "unknown compression mode"},
           {"\"mode\": \"ATTRIBUTES\"", "\"mode\": 1", "not a string"},
           {"\"mode\": \"ATTRIBUTES\"", "\"mode\": \"ATTRIBUTES\", \"filter\": \"X\"", "filter"},
           {"\"mode\": \"ATTRIBUTES\"", "\"mode\": \"ATTRIBUTES\", \"filter\": \"QUATERNION\"",
            "a count or byteStride"},
           {"\"mode\": \"ATTRIBUTES\"", "\"mode\": \"INDICES\"", "a count or byteStride"},
           {"\"byteStride\": 12", "\"byteStride\": 0", "a count or byteStride"},
           {"\"byteStride\": 12", "\"byteStride\": 4", "another length than its byteLength"},
           {"\"byteStride\": 12, \"count\": 576", "\"byteStride\": 12, \"count\": 0", "count"},
           {"{\"buffer\": 0, \"byteOffset\": 0", "{\"buffer\": 1, \"byteOffset\": 0",
            "in a buffer without data"},
           {"{\"buffer\": 0, \"byteOffset\": 0", "{\"buffer\": 0, \"byteOffset\": 9007199254740000",
            "reaches outside"},
           {"{\"buffer\": 0, \"byteOffset\": 0", "{\"buffer\": 7, \"byteOffset\": 0", "buffer"},
           {"{\"fallback\": true}", "{\"fallback\": 1}", "not a boolean"},
           {"\"EXT_meshopt_compression\": {\"buffer\"", "\"EXT_other\": {\"buffer\"",
            "lies in a buffer without data"}}) {
    SCOPED_TRACE(c.to);
    expect_error(ErrorCode::kBadInput, c.words,
                 [&] { MeshoptFile::read_text(replaced(good, c.from, c.to)); });
  }
}

TEST(GltfMeshopt, SizesThatCompressedBytesCannotHoldAreRefusedBeforeTheyAreMade) {
  // What compresses best, all zeros, must be allowed; two hundred times as much must not.
  const std::vector<float> zeros(3 * 30000, 0.0f);
  const Code code = vertex_code(zeros.data(), 30000, 12);
  MeshoptFile file;
  file.add(code, 30000, 12, kAttributes, kVec3);
  file.b.mesh("\"POSITION\": 0");
  file.b.add("nodes", "{\"mesh\": 0}");
  EXPECT_EQ(file.read().triangles.size(), 10000u);
  MeshoptFile bomb;
  bomb.add(code, std::size_t{30000} << 20, 12, kAttributes, kVec3);
  bomb.b.mesh("\"POSITION\": 0");
  bomb.b.add("nodes", "{\"mesh\": 0}");
  expect_error(ErrorCode::kBadInput, "compressed ones can hold", [&] { bomb.read(); });
}

TEST(GltfMeshopt, AnyCutOrFlippedByteIsReadOrRefusedInOneSentence) {
  const Grid grid(6);
  const Code positions = vertex_code(grid.positions.data(), grid.vertices(), 12);
  const Code triangles = triangle_code(grid.indices, grid.vertices());
  const auto try_codes = [&](const Code& p, const Code& t) {
    MeshoptFile file;
    file.add(p, grid.vertices(), 12, kAttributes, kVec3);
    file.add(t, grid.indices.size(), 4, "\"mode\": \"TRIANGLES\"", kIndex);
    file.b.mesh("\"POSITION\": 0", ", \"indices\": 1");
    file.b.add("nodes", "{\"mesh\": 0}");
    try {
      check_consistency(file.read());
      return true;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput) << error.what();
      return false;
    }
  };
  ASSERT_TRUE(try_codes(positions, triangles));
  for (std::size_t size = 1; size < positions.size(); ++size)
    EXPECT_FALSE(try_codes(Code(positions.begin(), positions.begin() + size), triangles));
  for (std::size_t size = 1; size < triangles.size(); ++size)
    EXPECT_FALSE(try_codes(positions, Code(triangles.begin(), triangles.begin() + size)));
  for (std::size_t at = 0; at < positions.size() + triangles.size(); ++at)
    for (const int flip : {0x01, 0x40, 0xff}) {
      Code p = positions, t = triangles;
      (at < p.size() ? p[at] : t[at - p.size()]) ^= static_cast<unsigned char>(flip);
      try_codes(p, t);
    }
}

#endif  // MDK_HAVE_MESHOPT

#ifdef MDK_HAVE_DRACO

/// The grid as a Draco mesh: POSITION has the unique id 0.
std::string draco_code(const Grid& grid, int method) {
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
  encoder.SetEncodingMethod(method);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
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

TEST(GltfDraco, BothMethodsGiveThePlainTrianglesWithinTheirQuantisation) {
  const Grid grid(17);
  const std::vector<std::vector<float>> plain = turned_triangles(read_plain(grid));
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    SCOPED_TRACE(method);
    PoseSequence s = read_built(draco_file(grid, draco_code(grid, method))).sequence;
    // A grid of 16 in 14 bits: off by half a thousandth, so that rounding to a 64th undoes it.
    for (Vec3f& p : s.positions)
      for (std::size_t a = 0; a < 3; ++a) {
        const float rounded = std::round(p[a] * 64) / 64;
        EXPECT_LT(std::abs(p[a] - rounded), 1e-3f);
        p[a] = rounded;
      }
    EXPECT_EQ(turned_triangles(s), plain);
  }
}

TEST(GltfDraco, WhatDoesNotFitItsAccessorsIsRefused) {
  const Grid grid(4);
  const std::string code = draco_code(grid, draco::MESH_EDGEBREAKER_ENCODING);
  struct Case {
    const char* list;
    int index;
    const char *from, *to, *words;
  };
  for (const Case& c : std::vector<Case>{
           {"accessors", 0, "\"count\": 16", "\"count\": 17", "other counts"},
           {"accessors", 0, "\"count\": 16", "\"count\": 15", "other counts"},
           {"accessors", 0, "VEC3", "VEC2", "other counts or components"},
           {"accessors", 1, "\"count\": 54", "\"count\": 51", "other counts"},
           {"accessors", 1, "\"count\": 54", "\"count\": 16000000", "other counts"},
           {"meshes", 0, "{\"POSITION\": 0}}", "{\"POSITION\": 9}}", "other counts"},
           {"meshes", 0, "{\"POSITION\": 0}}", "{\"POSITION\": -1}}", "no whole number"},
           {"meshes", 0, "{\"POSITION\": 0}}", "{\"NORMAL\": 0}}", "none of the primitive's own"},
           {"meshes", 0, "{\"POSITION\": 0}}", "[]}", "not an object"},
           {"meshes", 0, "\"bufferView\": 0", "\"bufferView\": 5", "bufferView"},
           {"meshes", 0, "\"indices\": 1", "\"mode\": 4", "no index list"},
           {"meshes", 0, "\"indices\": 1", "\"indices\": 1, \"mode\": 5", "no list of triangles"},
           {"meshes", 0, "\"indices\": 1", "\"indices\": 0", "shares accessor 0"}}) {
    SCOPED_TRACE(c.to);
    GltfBuilder b = draco_file(grid, code);
    b.at(c.list, c.index) = replaced(b.at(c.list, c.index), c.from, c.to);
    expect_error(ErrorCode::kBadInput, c.words, [&] { read_built(b); });
  }
}

TEST(GltfDraco, CountsThatSoFewBytesCannotHoldAreRefusedBeforeTheyAreMade) {
  const Grid grid(4);
  // A head that promises 5,000,000 faces of 100 vertices.
  std::string code("DRACO\2\2\1\1\0\0\0\x64", 13);
  for (const int byte : {0xc0, 0x96, 0xb1, 0x02}) code += static_cast<char>(byte);
  GltfBuilder b = draco_file(grid, code + std::string(100, '\0'));
  b.at("accessors", 1) = replaced(b.at("accessors", 1), "\"count\": 54", "\"count\": 15000000");
  expect_error(ErrorCode::kBadInput, "promises 5000000 faces", [&] { read_built(b); });
}

TEST(GltfDraco, OtherVersionsAndPointCloudsAreRefused) {
  const Grid grid(4);
  const std::string good = draco_code(grid, draco::MESH_EDGEBREAKER_ENCODING);
  for (const std::size_t at : {0u, 5u, 6u, 7u, 8u, 10u}) {
    std::string code = good;
    code[at] = static_cast<char>(code[at] ^ 0x82);
    expect_error(ErrorCode::kBadInput, "no plain mesh of version 2.2",
                 [&] { read_built(draco_file(grid, code)); });
  }
}

TEST(GltfDraco, AnyCutOrFlippedByteIsReadOrRefusedInOneSentence) {
  const Grid grid(6);
  for (const int method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const std::string good = draco_code(grid, method);
    for (std::size_t size = 1; size < good.size(); ++size)
      survive(draco_file(grid, good.substr(0, size)));
    for (std::size_t at = 0; at < good.size(); ++at)
      for (const int flip : {0x01, 0x40, 0xff}) {
        std::string code = good;
        code[at] = static_cast<char>(code[at] ^ flip);
        survive(draco_file(grid, code));
      }
  }
}

#endif  // MDK_HAVE_DRACO

TEST(GltfCompression, WithoutItsDecoderARequiredOneIsRefusedByTheNameOfItsPackage) {
  for (const auto& [name, package, can] :
       {std::tuple{"KHR_draco_mesh_compression", "libdraco-dev", gltf::can_decode_draco()},
        std::tuple{"EXT_meshopt_compression", "libmeshoptimizer-dev",
                   gltf::can_decode_meshopt()}}) {
    GltfBuilder b;
    b.triangle_mesh();
    b.add("nodes", "{\"mesh\": 0}");
    b.set("extensionsRequired", "[\"" + std::string(name) + "\"]");
    if (can)
      EXPECT_EQ(read_built(b).sequence.triangles.size(), 1u) << "required, but not used";
    else
      expect_error(ErrorCode::kBadInput, package, [&] { read_built(b); });
  }
}

}  // namespace
}  // namespace mdk::test
