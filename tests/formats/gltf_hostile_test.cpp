// Broken and hostile files: one sentence and kBadInput, never a crash, never another file's bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "tests/formats/gltf_builder.h"
#include "tests/formats/gltf_expect.h"

namespace mdk::test {
namespace {

/// A small file that uses most of the format: indices, a skin, a sparse morph target, an animation.
struct Numbers {
  std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::vector<std::uint16_t> indices = {0, 1, 2};
  std::vector<std::uint8_t> joints = {0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0};
  std::vector<float> times = {0, 1};
  std::vector<float> shifts = {0, 0, 0, 1, 0, 0};
  std::vector<std::uint16_t> sparse_indices = {1};
};

GltfBuilder whole_file(const Numbers& numbers = {}) {
  GltfBuilder b;
  b.accessor<float>("VEC3", numbers.positions);                           // accessor and view 0
  b.accessor<std::uint16_t>("SCALAR", numbers.indices);                   // 1
  b.accessor<std::uint8_t>("VEC4", numbers.joints);                       // 2
  b.accessor<float>("VEC4", {1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0, 1, 0, 0});  // 3
  b.accessor<float>("SCALAR", numbers.times);                             // 4
  b.accessor<float>("VEC3", numbers.shifts);                              // 5
  b.view<std::uint16_t>(numbers.sparse_indices);                          // view 6
  b.view<float>({0, 0, 1});                                               // view 7
  b.add("accessors",
        "{\"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\", \"sparse\": {\"count\": 1, "
        "\"indices\": {\"bufferView\": 6, \"componentType\": 5123}, \"values\": {\"bufferView\": "
        "7}}}");                                            // accessor 6
  b.accessor<float>("MAT4", std::vector<float>(32, 1.0f));  // accessor 7, view 8
  b.mesh("\"POSITION\": 0, \"JOINTS_0\": 2, \"WEIGHTS_0\": 3",
         ", \"indices\": 1, \"targets\": [{\"POSITION\": 6}]");
  b.add("nodes", "{\"mesh\": 0, \"skin\": 0, \"weights\": [0.5]}");
  b.add("nodes", "{\"children\": [2]}");
  b.add("nodes", "{}");
  b.add("skins", "{\"joints\": [1, 2]}");
  b.animation(1, "translation", 4, 5);
  b.set("extras", "{}");
  return b;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

void expect_bad_file(const std::string& json, const std::vector<std::string>& words) {
  const TempFolder folder;
  const std::string path = write_text(folder, "bad.gltf", json);
  std::vector<std::string> all = words;
  all.push_back("bad.gltf");
  expect_refused(ErrorCode::kBadInput, all, [&] { read_file(path); });
}

TEST(GltfHostile, TheWholeFileIsGoodBeforeItIsBroken) {
  EXPECT_EQ(read_built(whole_file()).sequence.key_count(), 31u);
}

TEST(GltfHostile, RefusesEveryBrokenProperty) {
  struct Case {
    std::string list;
    int index;
    std::string from, to;
    std::vector<std::string> words;
  };
  const std::vector<Case> cases = {
      {"meshes", 0, "\"POSITION\": 0", "\"POSITION\": 99", {"mesh 0", "POSITION", "99"}},
      {"meshes", 0, "\"POSITION\": 0", "\"POSITION\": 4294967296", {"mesh 0", "POSITION"}},
      {"meshes", 0, "\"POSITION\": 0", "\"POSITION\": \"0\"", {"mesh 0", "POSITION"}},
      {"meshes", 0, "\"POSITION\": 0", "\"POSITION\": 1", {"POSITION", "instead of 3"}},
      {"meshes", 0, "\"POSITION\": 6", "\"POSITION\": 99", {"mesh 0", "POSITION"}},
      {"meshes", 0, "\"POSITION\": 6", "\"POSITION\": 5", {"morph target", "length"}},
      {"meshes", 0, "\"indices\": 1", "\"indices\": \"one\"", {"mesh 0", "indices"}},
      {"meshes", 0, "\"indices\": 1", "\"indices\": -5", {"mesh 0", "indices"}},
      {"meshes", 0, "\"indices\": 1", "\"indices\": -1", {"mesh 0", "indices"}},
      {"meshes", 0, "\"indices\": 1", "\"indices\": 0.5", {"mesh 0", "indices"}},
      {"meshes", 0, "\"indices\": 1", "\"indices\": 4", {"accessor 4", "unsigned"}},
      {"meshes", 0, "\"indices\": 1", "\"mode\": 7", {"mesh 0", "mode"}},
      {"meshes", 0, "\"indices\": 1", "\"material\": 3", {"mesh 0", "material"}},
      {"meshes", 0, "\"JOINTS_0\": 2", "\"JOINTS_0\": 3", {"accessor 3", "unsigned"}},
      {"meshes", 0, "\"WEIGHTS_0\": 3", "\"WEIGHTS_0\": 5", {"WEIGHTS_0"}},
      {"accessors", 0, "\"count\": 3", "\"count\": 4000000000", {"accessor 0", "past"}},
      {"accessors", 0, "\"count\": 3", "\"count\": 9223372036854775807", {"accessor 0", "count"}},
      {"accessors", 0, "\"count\": 3", "\"count\": 4", {"accessor 0", "past"}},
      {"accessors", 0, "\"count\": 3", "\"count\": -3", {"accessor 0", "count"}},
      {"accessors", 0, "\"count\": 3", "\"count\": 0", {"accessor 0"}},
      {"accessors", 0, "\"bufferView\": 0", "\"bufferView\": 77", {"accessor 0", "bufferView"}},
      {"accessors", 0, "\"bufferView\": 0", "\"bufferView\": -7", {"accessor 0", "bufferView"}},
      {"accessors", 0, "\"count\"", "\"byteOffset\": -4, \"count\"", {"accessor 0", "byteOffset"}},
      {"accessors", 0, "\"count\"", "\"byteOffset\": 4, \"count\"", {"accessor 0", "past"}},
      {"accessors", 0, "\"count\"", "\"byteOffset\": 9007199254740000, \"count\"", {"accessor 0"}},
      {"accessors", 0, "5126", "5130", {"accessor 0", "componentType"}},
      {"accessors", 0, "5126", "5124", {"accessor 0", "componentType"}},
      {"accessors",
       6,
       "\"sparse\": {\"count\": 1",
       "\"sparse\": {\"count\": 1000000000",
       {"accessor 6"}},
      {"accessors", 6, "\"sparse\": {\"count\": 1", "\"sparse\": {\"count\": 2", {"accessor 6"}},
      {"accessors", 6, "\"sparse\": {\"count\": 1", "\"sparse\": {\"count\": -1", {"accessor 6"}},
      {"accessors", 6, "\"bufferView\": 7", "\"bufferView\": 70", {"accessor 6", "bufferView"}},
      {"accessors", 6, "5123", "5126", {"accessor 6", "sparse"}},
      {"accessors", 6, "\"count\": 3", "\"count\": 900000000", {"accessor 6", "no data"}},
      {"bufferViews", 0, "\"buffer\": 0", "\"buffer\": 42", {"buffer view 0", "buffer"}},
      {"bufferViews", 0, "\"byteOffset\": 0", "\"byteOffset\": -8", {"buffer view 0"}},
      {"bufferViews", 0, "\"byteOffset\": 0", "\"byteOffset\": 100000", {"buffer view 0"}},
      {"bufferViews", 0, "\"byteLength\": 36", "\"byteLength\": 1099511627776", {"buffer view 0"}},
      {"bufferViews",
       0,
       "\"byteLength\": 36",
       "\"byteLength\": 36, \"byteStride\": 8",
       {"accessor 0", "stride"}},
      {"bufferViews",
       0,
       "\"byteLength\": 36",
       "\"byteLength\": 36, \"byteStride\": 3",
       {"buffer view 0", "byteStride"}},
      {"bufferViews",
       0,
       "\"byteLength\": 36",
       "\"byteLength\": 36, \"byteStride\": 0",
       {"buffer view 0", "byteStride"}},
      {"nodes", 1, "[2]", "[1]", {"ring"}},
      {"nodes", 2, "{}", "{\"children\": [1]}", {"ring"}},
      {"nodes", 2, "{}", "{\"children\": [2]}", {"node 2", "two parents"}},
      {"nodes", 1, "[2]", "[2, 2]", {"node 2", "two parents"}},
      {"nodes", 1, "[2]", "[500]", {"node 1", "children"}},
      {"nodes", 0, "\"mesh\": 0", "\"mesh\": 8", {"node 0", "mesh"}},
      {"nodes", 0, "\"skin\": 0", "\"skin\": 8", {"node 0", "skin"}},
      {"nodes", 0, "\"weights\": [0.5]", "\"weights\": [\"x\"]", {"node 0", "weights"}},
      {"nodes", 2, "{}", "{\"rotation\": [0, 0, 1]}", {"node 2", "rotation"}},
      {"nodes", 2, "{}", "{\"matrix\": [1, 2, 3]}", {"node 2", "matrix"}},
      {"nodes",
       2,
       "{}",
       "{\"matrix\": [1,0,0,1, 0,1,0,0, 0,0,1,0, 0,0,0,1]}",
       {"node 2", "perspective"}},
      {"nodes", 2, "{}", "7", {"node 2"}},
      {"skins", 0, "[1, 2]", "[1, 500]", {"skin 0", "500"}},
      {"skins", 0, "[1, 2]", "[1]", {"joint 1", "skin 0"}},
      {"skins", 0, "[1, 2]", "[]", {"skin 0"}},
      {"skins", 0, "{", "{\"inverseBindMatrices\": 0, ", {"skin 0", "4x4"}},
      {"skins", 0, "[1, 2]", "[1, 2, 0], \"inverseBindMatrices\": 7", {"skin 0", "fewer"}},
      {"animations", 0, "\"sampler\": 0", "\"sampler\": 5", {"animation 0", "sampler"}},
      {"animations", 0, "\"node\": 1", "\"node\": 15", {"animation 0", "node"}},
      {"animations", 0, "\"input\": 4", "\"input\": 40", {"animation 0", "input"}},
      {"animations", 0, "\"input\": 4", "\"input\": 1", {"animation 0", "times"}},
      {"animations", 0, "\"output\": 5", "\"output\": 40", {"animation 0", "output"}},
      {"animations", 0, "\"output\": 5", "\"output\": 0", {"animation 0", "3 values"}},
      {"animations", 0, "LINEAR", "BEZIER", {"animation 0", "interpolation"}},
      {"animations", 0, "LINEAR", "CUBICSPLINE", {"animation 0", "values"}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.list + ": " + c.to);
    GltfBuilder b = whole_file();
    b.at(c.list, c.index) = replaced(b.at(c.list, c.index), c.from, c.to);
    expect_bad_file(b.json(), c.words);
  }
}

TEST(GltfHostile, RefusesBrokenNumbersInBuffers) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  Numbers n;
  n.positions[4] = nan;
  expect_bad_file(whole_file(n).json(), {"accessor 0", "not finite"});
  n.positions[4] = -infinity;
  expect_bad_file(whole_file(n).json(), {"accessor 0", "not finite"});
  n = {};
  n.indices[2] = 60000;
  expect_bad_file(whole_file(n).json(), {"mesh 0, primitive 0", "60000"});
  n = {};
  n.joints[9] = 255;
  expect_bad_file(whole_file(n).json(), {"joint 255"});
  n = {};
  n.times[1] = nan;
  expect_bad_file(whole_file(n).json(), {"accessor 4", "not finite"});
  n = {};
  n.shifts[3] = infinity;
  expect_bad_file(whole_file(n).json(), {"accessor 5", "not finite"});
  n = {};
  n.sparse_indices[0] = 3;
  expect_bad_file(whole_file(n).json(), {"accessor 6", "sparse"});
}

TEST(GltfHostile, RefusesVerticesThatOverflowOnTheWay) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + ", \"scale\": [1e300, 1, 1]}");
  b.add("nodes", "{\"children\": [0], \"scale\": [1e300, 1, 1]}");
  expect_bad_file(b.json(), {"clip \"static\"", "out of range"});
}

TEST(GltfHostile, RefusesWhatIsNotGltf) {
  const std::string good = whole_file().json();
  expect_bad_file("", {"JSON"});
  expect_bad_file("[]", {"JSON"});
  expect_bad_file("{}", {"asset"});
  expect_bad_file("solid cube\nfacet normal 0 0 1\n", {"JSON"});
  expect_bad_file(std::string(1000, '\0'), {"JSON"});
  expect_bad_file(replaced(good, "\"2.0\"", "\"1.0\""), {"glTF 1.0"});
  expect_bad_file(replaced(good, "\"2.0\"", "2.0"), {"version"});
  expect_bad_file(replaced(good, "0.5]", "1e999]"), {"out of range"});
  expect_bad_file(replaced(good, "\"skins\": [", "\"skins\": 7, \"unused\": ["), {"skins"});
  expect_bad_file(replaced(good, "base64,", "base64,!!!!"), {"decode"});
  expect_bad_file(replaced(good, "\"uri\": \"", "\"uri\": \"\", \"unused\": \""),
                  {"buffer 0", "uri"});
}

TEST(GltfHostile, DeepNestingIsRefusedBeforeItIsParsed) {
  for (const std::size_t depth : {std::size_t{300}, std::size_t{20000}, std::size_t{5000000}}) {
    const std::string nested = std::string(depth, '[') + std::string(depth, ']');
    expect_bad_file(replaced(whole_file().json(), "\"extras\": {}", "\"extras\": " + nested),
                    {"nested"});
  }
  // Brackets in a string are no nesting.
  GltfBuilder b = whole_file();
  b.set("extras", "\"\\\"" + std::string(1000, '[') + "\"");
  EXPECT_EQ(read_built(b).sequence.triangles.size(), 1u);
}

TEST(GltfHostile, ManyNodesInARowAreNoRecursion) {
  GltfBuilder b;
  b.add("nodes", "{\"mesh\": " + std::to_string(b.triangle_mesh()) + "}");
  for (int i = 0; i < 50000; ++i)
    b.add("nodes", "{\"children\": [" + std::to_string(i) + "], \"translation\": [1, 0, 0]}");
  EXPECT_EQ(read_built(b).sequence.pose(0)[0].x, 50000.0f);
}

TEST(GltfHostile, OpensNoFileOutsideItsFolder) {
  const TempFolder folder;
  const std::string secret(36, 'x');
  write_text(folder, "secret.bin", secret);
  GltfBuilder b = whole_file();
  for (const std::string uri :
       {"../secret.bin", "%2e%2e/secret.bin", "a/../../secret.bin", "..%2Fsecret.bin",
        "file:../secret.bin", "http://example.org/a.bin", "secret.bin%00.png", ".", ".."}) {
    SCOPED_TRACE(uri);
    b = whole_file();
    b.add("buffers", "{\"byteLength\": 36, \"uri\": \"" + uri + "\"}");
    for (int v = 0; v < 9; ++v) b.at("bufferViews", v) = "{\"buffer\": 0, \"byteLength\": 36}";
    const std::string path = write_text(folder, "inside/a.gltf", b.json());
    expect_refused(ErrorCode::kBadInput, {"a.gltf", "folder"}, [&] { read_file(path); });
  }
  b.at("buffers", 0) = "{\"byteLength\": 36, \"uri\": \"" + folder.file("secret.bin") + "\"}";
  const std::string path = write_text(folder, "inside/a.gltf", b.json());
  expect_refused(ErrorCode::kBadInput, {"a.gltf", "folder"}, [&] { read_file(path); });
}

TEST(GltfHostile, ANameLongerThanFilesHaveIsNotRepeatedAtLength) {
  GltfBuilder b = whole_file();
  b.add("buffers", "{\"byteLength\": 36, \"uri\": \"data" + std::string(100000, 'A') + "\"}");
  for (int v = 0; v < 9; ++v) b.at("bufferViews", v) = "{\"buffer\": 0, \"byteLength\": 36}";
  try {
    read_built(b);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("which at 100004 bytes is no name"));
    EXPECT_LT(std::string(error.what()).size(), 300u);
  }
}

TEST(GltfHostile, AnExtensionsNameNeitherCutsNorFloodsTheSentence) {
  GltfBuilder b = whole_file();
  b.set("extensionsRequired", "[\"X\\u0000\\u001b" + std::string(100000, 'y') + "\"]");
  try {
    read_built(b);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("needs the extension X??yyy"));
    EXPECT_THAT(error.what(), testing::HasSubstr(", which is not supported; export it again"));
    EXPECT_LT(std::string(error.what()).size(), 300u);
  }
}

TEST(GltfHostile, SaysWhichFileCannotBeRead) {
  const TempFolder folder;
  expect_refused(ErrorCode::kIo, {"nothing.glb", "no such file"},
                 [&] { read_file(folder.file("nothing.glb")); });
  expect_refused(ErrorCode::kIo, {"not a file"}, [&] { read_file(folder.path()); });

  GltfBuilder b = whole_file();
  b.add("buffers",
        "{\"byteLength\": " + std::to_string(b.bytes().size()) + ", \"uri\": \"part.bin\"}");
  const std::string path = write_text(folder, "a.gltf", b.json());
  expect_refused(ErrorCode::kIo, {"part.bin", "no such file"}, [&] { read_file(path); });
  std::filesystem::create_directory(folder.file("part.bin"));
  expect_refused(ErrorCode::kIo, {"part.bin", "not a file"}, [&] { read_file(path); });
  std::filesystem::remove(folder.file("part.bin"));
  for (std::size_t size = 0; size < b.bytes().size(); size += 7) {
    write_text(folder, "part.bin", b.bytes().substr(0, size));
    expect_refused(ErrorCode::kBadInput, {"part.bin", "cut short"}, [&] { read_file(path); });
  }
  write_text(folder, "part.bin", b.bytes());
  EXPECT_EQ(read_file(path).sequence.triangles.size(), 1u);
}

TEST(GltfHostile, RefusesATextFileCutAtAnyLength) {
  const std::string whole = whole_file().json();
  const TempFolder folder;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string path = write_text(folder, "cut.gltf", whole.substr(0, size));
    SCOPED_TRACE(size);
    expect_refused(ErrorCode::kBadInput, {"cut.gltf"}, [&] { read_file(path); });
  }
}

TEST(GltfHostile, RefusesABinaryFileCutAtAnyLength) {
  const std::string whole = whole_file().glb();
  const TempFolder folder;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string path = write_text(folder, "cut.glb", whole.substr(0, size));
    SCOPED_TRACE(size);
    expect_refused(ErrorCode::kBadInput, {"cut.glb"}, [&] { read_file(path); });
  }
}

TEST(GltfHostile, RefusesABinaryChunkThatReachesPastTheFile) {
  const std::string whole = whole_file().glb();
  const std::size_t chunk = whole.find(std::string("BIN\0", 4)) - 4;
  const TempFolder folder;
  for (const int more : {4, 8, 12}) {
    std::string bytes = whole;
    bytes[chunk] = static_cast<char>(bytes[chunk] + more);
    const std::string path = write_text(folder, "long.glb", bytes);
    expect_refused(ErrorCode::kBadInput, {"long.glb", "binary chunk"}, [&] { read_file(path); });
  }
}

TEST(GltfHostile, SurvivesAnySingleByteChanged) {
  const std::string whole = whole_file().glb();
  const TempFolder folder;
  std::size_t refused = 0;
  for (std::size_t at = 0; at < whole.size(); ++at) {
    std::string bytes = whole;
    const int flips[] = {0x01, 0x10, 0x80};
    bytes[at] = static_cast<char>(bytes[at] ^ flips[at % 3]);
    const std::string path = write_text(folder, "flipped.glb", bytes);
    try {
      check_consistency(read_file(path).sequence);
    } catch (const Error& error) {
      EXPECT_NE(error.code(), ErrorCode::kInternal) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, whole.size() / 2);
}

TEST(GltfHostile, ASmallFileCannotAskForEndlessMemory) {
  GltfBuilder b;
  b.add("accessors", "{\"componentType\": 5126, \"count\": 16777216, \"type\": \"VEC3\"}");
  b.mesh("\"POSITION\": 0");
  for (int i = 0; i < 100; ++i) b.add("nodes", "{\"mesh\": 0}");
  const TempFolder folder;
  const std::string path = write_text(folder, "many.gltf", b.json());
  expect_refused(ErrorCode::kOverLimit, {"many.gltf", "vertices"}, [&] { read_file(path); });

  GltfBuilder tracks;
  tracks.add("accessors", "{\"componentType\": 5126, \"count\": 16777216, \"type\": \"SCALAR\"}");
  tracks.add("accessors", "{\"componentType\": 5126, \"count\": 16777216, \"type\": \"VEC3\"}");
  tracks.add("nodes", "{\"mesh\": " + std::to_string(tracks.triangle_mesh()) + "}");
  for (int i = 0; i < 100; ++i) tracks.animation(0, "translation", 0, 1);
  tracks.at("animations", 0) = "{\"samplers\": [{\"input\": 0, \"output\": 1}], \"channels\": []}";
  std::string channels;
  for (int i = 0; i < 100; ++i)
    channels += std::string(i ? ", " : "") +
                "{\"sampler\": 0, \"target\": {\"node\": 0, \"path\": \"translation\"}}";
  tracks.at("animations", 0).insert(tracks.at("animations", 0).size() - 2, channels);
  const std::string tracks_path = write_text(folder, "tracks.gltf", tracks.json());
  expect_refused(ErrorCode::kOverLimit, {"tracks.gltf", "--clips"},
                 [&] { read_file(tracks_path); });
}

}  // namespace
}  // namespace mdk::test
