// Every rule of docs/file-format.md about a model's content: one fault each, found and named.
#include "formats/model_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/formats/fault.h"
#include "tests/formats/sample_model.h"

namespace mdk::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<Fault> count_faults() {
  using M = ModelStorage&;
  return {
      {"no_vertices", "vertices: 0", [](M m) { m.vertex_count = 0; }},
      {"too_many_vertices", "vertices: 1073741824", [](M m) { m.vertex_count = 1u << 30; }},
      {"other_vertex_count", "key_positions: 30 of them, not 33", [](M m) { m.vertex_count = 11; }},
      {"positions_cut", "key_positions: 29", [](M m) { m.poses.key_positions.pop_back(); }},
      {"no_keys", "key_times: 0", [](M m) { m.key_times.clear(); }},
      {"no_triangles", "triangles: 0", [](M m) { m.triangles.clear(); }},
      {"no_clusters", "clusters: 0", [](M m) { m.clusters.clear(); }},
      {"no_clips", "clips: 0", [](M m) { m.clips.clear(); }},
      {"no_materials", "materials: 0", [](M m) { m.appearance.materials.clear(); }},
      {"no_nodes", "kd_nodes: 0", [](M m) { m.kd_nodes.clear(); }},
      {"sources_cut", "source_triangles: 5", [](M m) { m.source_triangles.pop_back(); }},
      {"maps_cut", "local_from_world: 5", [](M m) { m.local_from_world.pop_back(); }},
      {"key_boxes_cut", "key_boxes: 2 of them, not 3", [](M m) { m.key_boxes.pop_back(); }},
      {"world_boxes_long", "cluster_world_boxes: 7",
       [](M m) { m.cluster_world_boxes.push_back({}); }},
      {"no_segments", "segments: 0", [](M m) { m.segments.clear(); }},
      {"more_segments_than_keys", "segments: 4", [](M m) { m.segments.resize(4); }},
      {"segment_without_boxes", "fuzzy_trees: 4 of them, not 6", [](M m) { m.segments.resize(3); }},
      {"fuzzy_trees_cut", "fuzzy_trees: 3", [](M m) { m.fuzzy_trees.pop_back(); }},
      {"fuzzy_boxes_cut", "fuzzy_boxes: 11 of them, not 12", [](M m) { m.fuzzy_boxes.pop_back(); }},
      {"triangle_materials_cut", "triangle_materials: 5",
       [](M m) { m.appearance.triangle_materials.pop_back(); }},
      {"texcoords_cut", "corner_texcoords: 17 of them, not 18",
       [](M m) { m.appearance.corner_texcoords.pop_back(); }},
      {"colors_long", "corner_colors: 19", [](M m) { m.appearance.corner_colors.push_back(0); }},
  };
}

std::vector<Fault> motion_faults() {
  using M = ModelStorage&;
  const double nan = std::nan("");
  return {
      {"rest_key_past_end", "model: rest key 3", [](M m) { m.rest_key = 3; }},
      {"rest_diagonal_nan", "model: the rest diagonal", [=](M m) { m.rest_diagonal = nan; }},
      {"rest_diagonal_negative", "model: the rest diagonal", [](M m) { m.rest_diagonal = -1; }},
      {"bounds_empty", "model: the bounds", [](M m) { m.bounds = Aabb{}; }},
      {"clip_gap", "clips: clip 1 does not start", [](M m) { m.clips[1].first_key = 1; }},
      {"clip_late_start", "clips: clip 0 does not start", [](M m) { m.clips[0].first_key = 1; }},
      {"clip_empty", "clips: clip 1 does not start", [](M m) { m.clips[1].key_count = 0; }},
      {"clip_long", "clips: clip 1 reaches past", [](M m) { m.clips[1].key_count = 2; }},
      {"clip_huge", "clips: clip 1 reaches past", [](M m) { m.clips[1].key_count = ~0u; }},
      {"keys_without_clip", "clips: they do not cover", [](M m) { m.clips.pop_back(); }},
      {"name_lone_continuation", "clips: clip 0 has a name",
       [](M m) { m.clips[0].name = "a\x80"; }},
      {"name_cut_sequence", "clips: clip 0 has a name", [](M m) { m.clips[0].name = "a\xe2\x82"; }},
      {"name_overlong", "clips: clip 0 has a name", [](M m) { m.clips[0].name = "\xe0\x80\x80"; }},
      {"name_surrogate", "clips: clip 0 has a name", [](M m) { m.clips[0].name = "\xed\xa0\x80"; }},
      {"name_past_unicode", "clips: clip 0 has a name",
       [](M m) { m.clips[0].name = "\xf4\x90\x80\x80"; }},
      {"time_negative", "key_times: key 0", [](M m) { m.key_times[0] = -0.001; }},
      {"time_equal", "key_times: key 1", [](M m) { m.key_times[1] = 0; }},
      {"time_falling", "key_times: key 1", [](M m) { m.key_times[0] = 1; }},
      {"time_nan", "key_times: key 2", [=](M m) { m.key_times[2] = nan; }},
      {"time_infinite", "key_times: key 1", [](M m) { m.key_times[1] = HUGE_VAL; }},
      {"segment_late_start", "segments: segment 0 does not start",
       [](M m) { m.segments[0].first_key = 1; }},
      {"segment_gap", "segments: segment 1 does not start",
       [](M m) { m.segments[0].last_key = 0; }},
      {"segment_shares_key_of_other_clip", "segments: segment 1 does not start",
       [](M m) { m.segments[1].first_key = 1; }},
      {"segment_goes_nowhere", "segments: segment 1 does not reach",
       [](M m) {
         m.segments[0] = {0, 0};
         m.segments[1] = {0, 0};
       }},
      {"segment_past_end", "segments: segment 1 reaches past",
       [](M m) { m.segments[1].last_key = 3; }},
      {"segment_huge", "segments: segment 0 reaches past",
       [](M m) { m.segments[0].last_key = ~0u; }},
      {"keys_in_no_segment", "segments: they do not cover",
       [](M m) {
         m.segments.resize(1);
         m.fuzzy_trees.resize(2);
         m.fuzzy_boxes.resize(6);
       }},
      {"key_box_nan", "key_boxes: number 2", [](M m) { m.key_boxes[2].lo.y = kNan; }},
      {"key_box_infinite", "key_boxes: number 0", [](M m) { m.key_boxes[0].hi.z = kInf; }},
      {"key_box_inverted", "key_boxes: number 1",
       [](M m) { std::swap(m.key_boxes[1].lo, m.key_boxes[1].hi); }},
      {"world_box_inverted", "cluster_world_boxes: number 1",
       [](M m) { std::swap(m.cluster_world_boxes[1].lo, m.cluster_world_boxes[1].hi); }},
      {"fuzzy_box_inverted", "fuzzy_boxes: number 11",
       [](M m) {
         m.fuzzy_boxes[11] = {{0, 0, 2}, {0, 0, 1}};
       }},
      {"fuzzy_box_past_its_end", "fuzzy_boxes: number 0",
       [](M m) {
         m.fuzzy_boxes[0] = {{65535, 0, 0}, {65534, 0, 0}};
       }},
      {"map_infinite", "local_from_world: map 2",
       [](M m) { m.local_from_world[2].m[2][3] = kInf; }},
      {"map_nan", "local_from_world: map 5", [](M m) { m.local_from_world[5].m[0][0] = kNan; }},
  };
}

std::vector<Fault> link_faults() {
  using M = ModelStorage&;
  return {
      {"vertex_past_end", "triangles: triangle 5", [](M m) { m.triangles[5].v[2] = 10; }},
      {"source_past_end", "source_triangles: triangle 2", [](M m) { m.source_triangles[2] = 6; }},
      {"cluster_gap", "clusters: cluster 1: its triangles do not start",
       [](M m) { m.clusters[1].first_triangle = 5; }},
      {"cluster_long", "clusters: cluster 1: its triangles reach past",
       [](M m) { m.clusters[1].triangle_count = ~0u; }},
      {"cluster_empty", "clusters: cluster 0 has no triangles",
       [](M m) { m.clusters[0].triangle_count = 0; }},
      {"triangles_in_none", "clusters: some triangles",
       [](M m) { m.clusters[1].triangle_count = 1; }},
      {"tree_empty", "fuzzy_trees: tree 0 is empty", [](M m) { m.fuzzy_trees[0].node_count = 0; }},
      {"nodes_long", "fuzzy_trees: tree 3: its nodes reach",
       [](M m) { m.fuzzy_trees[3].node_count = 2; }},
      {"nodes_in_none", "fuzzy_trees: some nodes", [](M m) { m.kd_nodes.push_back({}); }},
      {"refs_gap", "fuzzy_trees: tree 1: its references do not start",
       [](M m) { m.fuzzy_trees[1].first_ref = 4; }},
      {"refs_in_none", "fuzzy_trees: some references", [](M m) { m.kd_refs.push_back(5); }},
      {"local_box_nan", "fuzzy_trees: tree 1 has a local box",
       [](M m) { m.fuzzy_trees[1].local_box.hi.x = kNan; }},
      {"tree_loop", "kd_nodes: tree 0", [](M m) { m.kd_nodes[2] = KdNode::inner(1, 2.0f, 1); }},
      {"tree_past_end", "kd_nodes: tree 0", [](M m) { m.kd_nodes[2] = KdNode::inner(1, 2.0f, 4); }},
      {"tree_split_nan", "kd_nodes: tree 0",
       [](M m) { m.kd_nodes[0] = KdNode::inner(0, kNan, 1); }},
      {"leaf_past_end", "kd_nodes: tree 1", [](M m) { m.kd_nodes[5] = KdNode::leaf(1, 2); }},
      {"ref_of_other_cluster", "kd_nodes: tree 0", [](M m) { m.kd_refs[1] = 4; }},
      {"ref_of_other_cluster_later", "kd_nodes: tree 2", [](M m) { m.kd_refs[7] = 4; }},
  };
}

std::vector<Fault> appearance_faults() {
  using M = ModelStorage&;
  return {
      {"color_nan", "materials: material 0 has a colour",
       [](M m) { m.appearance.materials[0].base_color[3] = kNan; }},
      {"color_bright", "materials: material 1 has a colour",
       [](M m) { m.appearance.materials[1].base_color[0] = 1.001f; }},
      {"texture_past_end", "materials: material 1 names texture 2",
       [](M m) { m.appearance.materials[1].texture = 2; }},
      {"unknown_flag", "materials: material 0 has unknown flags",
       [](M m) { m.appearance.materials[0].flags = 4; }},
      {"unknown_wrap_u", "materials: material 0 has an unknown wrap",
       [](M m) { m.appearance.materials[0].wrap_u = static_cast<TextureWrap>(3); }},
      {"unknown_wrap_v", "materials: material 0 has an unknown wrap",
       [](M m) { m.appearance.materials[0].wrap_v = static_cast<TextureWrap>(~0u); }},
      {"material_past_end", "triangle_materials: triangle 3",
       [](M m) { m.appearance.triangle_materials[3] = 2; }},
      {"texture_no_width", "textures: texture 0 has an impossible size",
       [](M m) { m.appearance.textures[0].width = 0; }},
      {"texture_no_height", "textures: texture 1 has an impossible size",
       [](M m) { m.appearance.textures[1].height = 0; }},
      {"texture_huge", "textures: texture 1 has an impossible size",
       [](M m) { m.appearance.textures[1].width = ~0u; }},
      {"texture_long", "textures: texture 1 reaches past",
       [](M m) { m.appearance.textures[1].height = 3; }},
      {"texture_late", "textures: texture 1 reaches past",
       [](M m) { m.appearance.textures[1].first_texel = 2; }},
      {"texture_wraps_around", "textures: texture 1 reaches past",
       [](M m) { m.appearance.textures[1].first_texel = ~std::uint64_t{0}; }},
  };
}

class EveryFault : public testing::TestWithParam<Fault> {};

TEST_P(EveryFault, IsFoundAndNamed) {
  ModelStorage model = sample_model();
  ASSERT_EQ(find_inconsistency(model.view()), "");
  GetParam().make(model);
  EXPECT_THAT(find_inconsistency(model.view()), testing::StartsWith(GetParam().sentence));
}

INSTANTIATE_TEST_SUITE_P(Counts, EveryFault, testing::ValuesIn(count_faults()), fault_name);
INSTANTIATE_TEST_SUITE_P(Motion, EveryFault, testing::ValuesIn(motion_faults()), fault_name);
INSTANTIATE_TEST_SUITE_P(Links, EveryFault, testing::ValuesIn(link_faults()), fault_name);
INSTANTIATE_TEST_SUITE_P(Look, EveryFault, testing::ValuesIn(appearance_faults()), fault_name);

TEST(FindInconsistency, AllowsNamesInAnyScript) {
  ModelStorage model = sample_model();
  model.clips[0].name = "ходьба 歩く 🚶 \xf4\x8f\xbf\xbf";
  EXPECT_EQ(find_inconsistency(model.view()), "");
}

}  // namespace
}  // namespace mdk::test
