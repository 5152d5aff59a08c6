#include "tests/formats/mdk_file.h"

#include <gmock/gmock.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "common/base/error.h"
#include "formats/mdk_view.h"
#include "formats/mdk_writer.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/sample_model.h"

namespace mdk::test {
namespace {

template <class T>
void expect_same(const char* name, std::span<const T> mapped, const std::vector<T>& original) {
  ASSERT_EQ(mapped.size(), original.size()) << name;
  if (original.empty()) return;
  EXPECT_EQ(std::memcmp(mapped.data(), original.data(), mapped.size_bytes()), 0) << name;
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(mapped.data()) % 64, 0u) << name;
}

void expect_same_poses(const PoseSource& mapped, const PoseStorage& original) {
  EXPECT_EQ(mapped.kind, original.kind);
  expect_same("key_positions", mapped.key_positions, original.key_positions);
  expect_same("base_positions", mapped.rig.base_positions, original.rig.base_positions);
  expect_same("first_weight", mapped.rig.first_weight, original.rig.first_weight);
  expect_same("bone_weights", mapped.rig.bone_weights, original.rig.bone_weights);
  expect_same("first_offset", mapped.rig.first_offset, original.rig.first_offset);
  expect_same("morph_offsets", mapped.rig.morph_offsets, original.rig.morph_offsets);
  expect_same("bone_maps", mapped.rig.bone_maps, original.rig.bone_maps);
  expect_same("quantization_error", mapped.quantized.error, original.quantized.error);
  expect_same("first_vertex", mapped.quantized.first_vertex, original.quantized.first_vertex);
  expect_same("rest_positions", mapped.quantized.rest_positions, original.quantized.rest_positions);
  expect_same("quantized_blocks", mapped.quantized.blocks, original.quantized.blocks);
  expect_same("quantized_words", mapped.quantized.words, original.quantized.words);
  expect_same("target_weights", mapped.rig.target_weights, original.rig.target_weights);
}

}  // namespace

std::string MdkFileTest::written(const ModelStorage& storage) {
  write_mdk(storage.view(), path_);
  return path_;
}

Bytes MdkFileTest::sample_bytes() { return read_bytes(written(sample_model())); }

void MdkFileTest::expect_refused(const Bytes& bytes, const std::string& words) {
  write_bytes(path_, bytes);
  expect_error(ErrorCode::kBadInput, words, [&] { MdkFile file(path_); });
}

void expect_same_model(const Model& mapped, const ModelStorage& original) {
  EXPECT_EQ(mapped.vertex_count, original.vertex_count);
  EXPECT_EQ(mapped.rest_key, original.rest_key);
  EXPECT_EQ(mapped.bounds, original.bounds);
  EXPECT_EQ(mapped.rest_diagonal, original.rest_diagonal);
  EXPECT_THAT(mapped.clips, testing::ElementsAreArray(original.clips));
  expect_same("key_times", mapped.key_times, original.key_times);
  expect_same_poses(mapped.poses, original.poses);
  expect_same("triangles", mapped.triangles, original.triangles);
  expect_same("source_triangles", mapped.source_triangles, original.source_triangles);
  expect_same("clusters", mapped.clusters, original.clusters);
  expect_same("local_from_world", mapped.local_from_world, original.local_from_world);
  expect_same("key_boxes", mapped.key_boxes, original.key_boxes);
  expect_same("cluster_world_boxes", mapped.cluster_world_boxes, original.cluster_world_boxes);
  expect_same("segments", mapped.segments, original.segments);
  expect_same("fuzzy_trees", mapped.fuzzy_trees, original.fuzzy_trees);
  expect_same("fuzzy_boxes", mapped.fuzzy_boxes, original.fuzzy_boxes);
  expect_same("kd_nodes", mapped.kd_nodes, original.kd_nodes);
  expect_same("kd_refs", mapped.kd_refs, original.kd_refs);
  const Appearance& look = original.appearance;
  expect_same("materials", mapped.materials, look.materials);
  expect_same("triangle_materials", mapped.triangle_materials, look.triangle_materials);
  expect_same("corner_texcoords", mapped.corner_texcoords, look.corner_texcoords);
  expect_same("corner_colors", mapped.corner_colors, look.corner_colors);
  expect_same("textures", mapped.textures, look.textures);
  expect_same("texels", mapped.texels, look.texels);
}

}  // namespace mdk::test
