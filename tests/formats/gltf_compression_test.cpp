// Compressed glTF, made here by the libraries that define the compressions.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "formats/gltf/compression.h"
#include "tests/formats/compressed_gltf.h"
#include "tests/formats/expect_error.h"

#ifdef MDK_HAVE_MESHOPT
#include <meshoptimizer.h>
#endif

namespace mdk::test {
namespace {

using testing::HasSubstr;

// Where a decoder is missing, so are the tests that use some of these.

[[maybe_unused]] PoseSequence read_plain(const Grid& grid) {
  GltfBuilder b;
  const int positions = b.accessor("VEC3", grid.positions);
  const int indices = b.accessor("SCALAR", grid.indices);
  b.mesh("\"POSITION\": " + std::to_string(positions), ", \"indices\": " + std::to_string(indices));
  b.add("nodes", "{\"mesh\": 0}");
  return read_built(b).sequence;
}

/// Corner positions, each triangle turned so that its smallest corner comes first; sorted.
[[maybe_unused]] std::vector<std::vector<float>> turned_triangles(const PoseSequence& s) {
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

[[maybe_unused]] std::string replaced(std::string text, const std::string& from,
                                      const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// Reads what was built, which must give a mesh or one sentence.
[[maybe_unused]] void survive(const GltfBuilder& b) {
  try {
    check_consistency(read_built(b).sequence);
  } catch (const Error& error) {
    EXPECT_NE(error.code(), ErrorCode::kInternal) << error.what();
    EXPECT_THAT(error.what(), testing::Not(HasSubstr("\n")));
  }
}

#ifdef MDK_HAVE_MESHOPT

TEST(GltfMeshopt, AttributesAndTrianglesAreThoseOfThePlainFile) {
  const Grid grid(24);
  EXPECT_EQ(turned_triangles(packed(grid).read()), turned_triangles(read_plain(grid)));
}

TEST(GltfMeshopt, IndexSequencesKeepTheirOrder) {
  const Grid grid(5);
  MeshoptFile file;
  file.add(vertex_code(grid.positions.data(), grid.vertices(), 12), grid.vertices(), 12,
           kAttributes, kVec3);
  file.add(index_code(grid.indices, grid.vertices()), grid.indices.size(), 4, kIndices, kIndex);
  file.b.mesh("\"POSITION\": 0", ", \"indices\": 1");
  file.b.add("nodes", "{\"mesh\": 0}");
  EXPECT_EQ(file.read().triangles, read_plain(grid).triangles);
  EXPECT_EQ(file.read().positions, read_plain(grid).positions);
}

TEST(GltfMeshopt, ReadsBinaryFilesWithAFallbackThatIsNotThere) {
  const Grid grid(9);
  const TempFolder folder;
  const ReadResult result = read_file(write_text(folder, "packed.glb", packed(grid).glb()));
  EXPECT_EQ(turned_triangles(result.sequence), turned_triangles(read_plain(grid)));
  EXPECT_THAT(result.dependencies, testing::SizeIs(1));
  // What follows the length that the file has by its header is no part of it.
  const ReadResult longer =
      read_file(write_text(folder, "longer.glb", packed(grid).glb() + "and more"));
  EXPECT_EQ(longer.sequence.triangles, result.sequence.triangles);
}

TEST(GltfMeshopt, FiltersAreUndone) {
  // Exponents: 2^E * M, here exact. Quaternions: a half turn about z, and one about x.
  const Grid grid(6);
  MeshoptFile file;
  std::vector<float> filtered(grid.positions.size());
  meshopt_encodeFilterExp(filtered.data(), grid.vertices(), 12, 23, grid.positions.data());
  file.add(vertex_code(filtered.data(), grid.vertices(), 12), grid.vertices(), 12,
           "\"mode\": \"ATTRIBUTES\", \"filter\": \"EXPONENTIAL\"", kVec3);
  file.add(index_code(grid.indices, grid.vertices()), grid.indices.size(), 4, kIndices, kIndex);
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
    file.add(t, grid.indices.size(), 4, kTriangles, kIndex);
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

TEST(GltfDraco, BothMethodsGiveThePlainTrianglesWithinTheirQuantisation) {
  const Grid grid(17);
  const std::vector<std::vector<float>> plain = turned_triangles(read_plain(grid));
  for (const DracoMethod method : {DracoMethod::kSequential, DracoMethod::kEdgebreaker}) {
    SCOPED_TRACE(static_cast<int>(method));
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
  const std::string code = draco_code(grid, DracoMethod::kEdgebreaker);
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
  const std::string good = draco_code(grid, DracoMethod::kEdgebreaker);
  for (const std::size_t at : {0u, 5u, 6u, 7u, 8u, 10u}) {
    std::string code = good;
    code[at] = static_cast<char>(code[at] ^ 0x82);
    expect_error(ErrorCode::kBadInput, "no plain mesh of version 2.2",
                 [&] { read_built(draco_file(grid, code)); });
  }
}

TEST(GltfDraco, AnyCutOrFlippedByteIsReadOrRefusedInOneSentence) {
  const Grid grid(6);
  for (const DracoMethod method : {DracoMethod::kSequential, DracoMethod::kEdgebreaker}) {
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
