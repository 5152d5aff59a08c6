// glTF, text and binary, through the whole reader.
#include <numeric>

#include "formats/files/image_writer.h"
#include "formats/gltf/reader.h"
#include "tests/formats/compressed_gltf.h"
#include "tests/formats/gltf_builder.h"
#include "tests/fuzz/fuzz_target.h"

namespace mdk::test {
namespace {

constexpr std::size_t kMostPoseBytes = std::size_t{64} << 20;

void read(std::span<const unsigned char> bytes) {
  static FuzzFile file("a.gltf");
  SilentProgress silent;
  const std::string& path = file.holding(bytes);
  for (const bool skeleton : {false, true}) {
    const ReadOptions options{
        .fps = 4, .clips = {}, .skeleton = skeleton, .most_pose_bytes = kMostPoseBytes};
    read_gltf(path, options, silent);
  }
}

std::string number(int value) { return std::to_string(value); }

/// A square of two triangles in a strip, with colours, texture coordinates and a picture.
GltfBuilder textured() {
  GltfBuilder b;
  const int positions = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  const int normals = b.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int texcoords =
      b.accessor<std::uint16_t>("VEC2", {0, 0, 65535, 0, 0, 65535, 9, 9}, ", \"normalized\": true");
  const int colors = b.accessor<float>("VEC3", {1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1});
  const int indices = b.accessor<std::uint8_t>("SCALAR", {0, 1, 2, 3});
  b.mesh("\"POSITION\": " + number(positions) + ", \"NORMAL\": " + number(normals) +
             ", \"TEXCOORD_0\": " + number(texcoords) + ", \"COLOR_0\": " + number(colors),
         ", \"mode\": 5, \"material\": 0, \"indices\": " + number(indices));
  b.add("nodes", "{\"mesh\": 0, \"matrix\": [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 2, 3, 4, 1]}");
  b.add("scenes", "{\"nodes\": [0]}");
  const TempFolder folder;
  std::vector<std::uint32_t> pixels(4);
  std::iota(pixels.begin(), pixels.end(), 0xff102030u);
  write_png(folder.file("a.png"), 2, 2, pixels);
  const int picture = b.view(read_bytes(folder.file("a.png")));
  b.add("images", "{\"mimeType\": \"image/png\", \"bufferView\": " + number(picture) + "}");
  b.add("textures", "{\"source\": 0, \"sampler\": 0}");
  b.add("samplers", "{\"wrapS\": 33071}");
  b.add("materials",
        "{\"extensions\": {\"KHR_materials_unlit\": {}}, \"pbrMetallicRoughness\": "
        "{\"baseColorFactor\": [1, 0.5, 0, 1], \"baseColorTexture\": {\"index\": 0, "
        "\"extensions\": {\"KHR_texture_transform\": {\"offset\": [0.5, 0], \"rotation\": 1, "
        "\"scale\": [2, 3], \"texCoord\": 0}}}}}");
  return b;
}

/// A skin of two joints below each other, one turned by LINEAR, one carried by STEP.
GltfBuilder skinned() {
  GltfBuilder b;
  const int positions = b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int joints = b.accessor<std::uint8_t>("VEC4", {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0});
  const int weights = b.accessor<float>("VEC4", {0.5f, 0.5f, 0, 0, 1, 0, 0, 0, 0.25f, 0.25f, 0, 0});
  b.mesh("\"POSITION\": " + number(positions) + ", \"JOINTS_0\": " + number(joints) +
         ", \"WEIGHTS_0\": " + number(weights));
  const int binds = b.accessor<float>("MAT4", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,  //
                                               1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1});
  b.add("nodes", "{\"mesh\": 0, \"skin\": 0}");
  b.add("nodes", "{\"name\": \"hip\", \"children\": [2]}");
  b.add("nodes", "{\"name\": \"tail\", \"translation\": [0, 1, 0], \"scale\": [1, -1, 1]}");
  b.add("skins",
        "{\"joints\": [1, 2], \"skeleton\": 1, \"inverseBindMatrices\": " + number(binds) + "}");
  const int times = b.accessor<float>("SCALAR", {0.5f, 1});
  b.animation(2, "rotation", times, b.accessor<float>("VEC4", {0, 0, 0, 1, 0, 0, 1, 0}));
  b.animation(1, "translation", times, b.accessor<float>("VEC3", {0, 0, 0, 5, 0, 0}), "STEP");
  return b;
}

/// Morph targets by CUBICSPLINE over sparse, interleaved and quantised accessors.
GltfBuilder morphed() {
  GltfBuilder b;
  const int view =
      b.view(std::vector<std::int16_t>{0, 0, 0, 7, 9, 0, 0, 7, 0, 9, 0, 7}, ", \"byteStride\": 8");
  const int positions = b.add("accessors",
                              "{\"componentType\": 5122, \"count\": 3, \"type\": \"VEC3\", "
                              "\"bufferView\": " +
                                  number(view) + "}");
  const int indices = b.view(std::vector<std::uint8_t>{1});
  const int values = b.view(std::vector<float>{0, 0, 2});
  const int offsets =
      b.add("accessors",
            "{\"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\", \"sparse\": "
            "{\"count\": 1, \"indices\": {\"componentType\": 5121, \"bufferView\": " +
                number(indices) + "}, \"values\": {\"bufferView\": " + number(values) + "}}}");
  b.mesh("\"POSITION\": " + number(positions),
         ", \"targets\": [{\"POSITION\": " + number(offsets) + "}]");
  b.at("meshes", 0).insert(1, "\"weights\": [0.5], ");
  b.add("nodes", "{\"mesh\": 0}");
  const int times = b.accessor<float>("SCALAR", {0, 0.5f});
  b.animation(0, "weights", times, b.accessor<float>("SCALAR", {0, 0, 1, 1, 1, 0}), "CUBICSPLINE");
  b.set("extensionsRequired", "[\"KHR_mesh_quantization\"]");
  return b;
}

std::vector<Bytes> gltf_seeds() {
  std::vector<Bytes> seeds;
  for (const GltfBuilder& b : {textured(), skinned(), morphed()}) {
    seeds.push_back(bytes_of(b.json()));
    seeds.push_back(bytes_of(b.glb()));
  }
#ifdef MDK_HAVE_MESHOPT
  seeds.push_back(bytes_of(packed(Grid(3)).glb()));
#endif
#ifdef MDK_HAVE_DRACO
  const Grid grid(3);
  seeds.push_back(bytes_of(draco_file(grid, draco_code(grid, DracoMethod::kEdgebreaker)).glb()));
#endif
  return seeds;
}

}  // namespace

const FuzzTarget& gltf_target() {
  static const FuzzTarget target = {"gltf", read, gltf_seeds};
  return target;
}

}  // namespace mdk::test
