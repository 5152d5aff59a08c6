// Every rule of docs/file-format.md about a model's content, its poses and its skeleton: one fault
// each, found and named.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "common/motion/posed_mesh.h"
#include "formats/mdk/mdk_file.h"
#include "formats/mdk/writer.h"
#include "tests/formats/mdk/sample_model.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// One way to break a sample model, and the sentence that has to name it.
struct Fault {
  std::string name;
  std::string sentence;  ///< how it must begin
  std::function<void(ModelStorage&)> make;
};

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

std::vector<Fault> rig_size_faults() {
  using M = ModelStorage&;
  return {
      {"unknown_kind", "model: the kind of its poses",
       [](M m) {
         m.poses.kind = static_cast<PoseKind>(9);
         m.poses.rig = {};
       }},
      {"positions_beside_a_rig", "key_positions: there",
       [](M m) { m.poses.key_positions.resize(30); }},
      {"rig_beside_positions", "bone_maps: there, though poses are stored in another way",
       [](M m) { m.poses.kind = PoseKind::kKeyPositions; }},
      {"base_cut", "base_positions: 9 of them, not 10",
       [](M m) { m.poses.rig.base_positions.pop_back(); }},
      {"first_weight_cut", "first_weight: 10 of them, not 11",
       [](M m) { m.poses.rig.first_weight.pop_back(); }},
      {"first_offset_long", "first_offset: 12 of them, not 11",
       [](M m) { m.poses.rig.first_offset.push_back(6); }},
      {"offsets_without_first", "morph_offsets: 6 of them, not 0",
       [](M m) { m.poses.rig.first_offset.clear(); }},
      {"bone_maps_cut", "bone_maps: 8 of them", [](M m) { m.poses.rig.bone_maps.pop_back(); }},
      {"target_weights_long", "target_weights: 4 of them",
       [](M m) { m.poses.rig.target_weights.push_back(0); }},
  };
}

std::vector<Fault> rig_link_faults() {
  using M = ModelStorage&;
  return {
      {"weights_late", "first_weight: the runs do not cover",
       [](M m) { m.poses.rig.first_weight[0] = 1; }},
      {"weights_cut", "first_weight: the runs do not cover",
       [](M m) { m.poses.rig.bone_weights.pop_back(); }},
      {"weights_none", "first_weight: run 3",
       [](M m) { m.poses.rig.first_weight[4] = m.poses.rig.first_weight[3]; }},
      {"weights_fall", "first_weight: run 4", [](M m) { m.poses.rig.first_weight[4] = ~0u; }},
      {"bone_past_end", "bone_weights: number 2 names bone 3 of 3",
       [](M m) { m.poses.rig.bone_weights[2].bone = 3; }},
      {"no_bones", "bone_weights: number 0 names bone 0 of 0",
       [](M m) { m.poses.rig.bone_maps.clear(); }},
      {"offsets_late", "first_offset: the runs do not cover",
       [](M m) { m.poses.rig.first_offset[0] = 1; }},
      {"offsets_fall", "first_offset: run 2", [](M m) { m.poses.rig.first_offset[2] = 5; }},
      {"target_past_end", "morph_offsets: number 5 names target 1 of 1",
       [](M m) { m.poses.rig.morph_offsets[5].target = 1; }},
      {"no_targets", "morph_offsets: number 0 names target 0 of 0",
       [](M m) { m.poses.rig.target_weights.clear(); }},
  };
}

std::vector<Fault> rig_number_faults() {
  using M = ModelStorage&;
  return {
      {"base_nan", "base_positions: number 4", [](M m) { m.poses.rig.base_positions[4].z = kNan; }},
      {"weight_infinite", "bone_weights: number 1",
       [](M m) { m.poses.rig.bone_weights[1].weight = kInf; }},
      {"offset_nan", "morph_offsets: number 0",
       [](M m) { m.poses.rig.morph_offsets[0].offset.y = kNan; }},
      {"bone_map_infinite", "bone_maps: number 8",
       [](M m) { m.poses.rig.bone_maps[8].m[2][3] = -kInf; }},
      {"target_weight_nan", "target_weights: number 2",
       [](M m) { m.poses.rig.target_weights[2] = kNan; }},
  };
}

std::vector<Fault> quantized_faults() {
  using Q = QuantizedPoses&;
  const auto fault = [](const char* name, const char* sentence, void (*damage)(Q)) {
    return Fault{name, sentence, [damage](ModelStorage& m) { damage(m.poses.quantized); }};
  };
  return {
      {"of_another_kind", "quantization_error: there",
       [](ModelStorage& m) { m.poses.kind = PoseKind::kKeyPositions; }},
      fault("no_error", "quantization_error: 0 of them, not 1", [](Q q) { q.error.clear(); }),
      fault("error_past_bound", "quantization_error: the largest",
            [](Q q) { q.error[0].largest = 2 * q.error[0].bound; }),
      fault("error_nan", "quantization_error: the largest",
            [](Q q) { q.error[0].largest = static_cast<double>(kNan); }),
      fault("no_runs", "first_vertex: 0 of them, where 2", [](Q q) { q.first_vertex.clear(); }),
      fault("run_empty", "first_vertex: run 0 ends too early",
            [](Q q) {
              q.first_vertex = {0, 0, 10};
            }),
      fault("run_past_end", "first_vertex: the runs do not cover",
            [](Q q) { q.first_vertex[2] = 11; }),
      fault("rest_cut", "rest_positions: 9 of them, not 10",
            [](Q q) { q.rest_positions.pop_back(); }),
      fault("rest_nan", "rest_positions: number 3", [](Q q) { q.rest_positions[3].x = kNan; }),
      fault("blocks_cut", "quantized_blocks: 5 of them, not 6", [](Q q) { q.blocks.pop_back(); }),
      fault("many_bits", "quantized_blocks: block 2 has coordinates",
            [](Q q) { q.blocks[2].bits[1] = 17; }),
      fault("step_infinite", "quantized_blocks: block 1 has a number",
            [](Q q) { q.blocks[1].step.z = kInf; }),
      fault("map_nan", "quantized_blocks: block 4 has a number",
            [](Q q) { q.blocks[4].world_from_local.m[0][3] = kNan; }),
      fault("block_elsewhere", "quantized_blocks: block 3 does not start",
            [](Q q) { q.blocks[3].first_bit = 0; }),
      fault("words_cut", "quantized_words: 6 of them, not 7", [](Q q) { q.words.pop_back(); }),
      fault("more_bits_than_words", "quantized_words: 7 of them, not 9",
            [](Q q) { q.blocks[5].bits[2] = 16; }),
  };
}

std::vector<Fault> skeleton_faults() {
  using M = ModelStorage&;
  return {
      {"names_without_joints", "joint_names: there, though there are no joints",
       [](M m) { m.skeleton.joints.clear(); }},
      {"bones_without_joints", "bone_bindings: there, though",
       [](M m) {
         m.skeleton.joints.clear();
         m.skeleton.names.clear();
       }},
      {"clusters_without_joints", "cluster_bones: there, though", [](M m) { m.skeleton = {}; }},
      {"bindings_cut", "bone_bindings: 2 of them, not 3", [](M m) { m.skeleton.bones.pop_back(); }},
      {"cluster_bones_long", "cluster_bones: 3 of them, not 2",
       [](M m) { m.cluster_bones.push_back({}); }},
      {"parent_after", "joints: joint 1 does not stand",
       [](M m) { m.skeleton.joints[1].parent = 1; }},
      {"limit_nan", "joints: joint 0 has a limit", [](M m) { m.skeleton.joints[0].limit = kNan; }},
      {"limit_negative", "joints: joint 1 has a limit",
       [](M m) { m.skeleton.joints[1].limit = -0.1f; }},
      {"limit_wide", "joints: joint 1 has a limit", [](M m) { m.skeleton.joints[1].limit = 3.2f; }},
      {"name_gap", "joints: joint 1 has no name",
       [](M m) { m.skeleton.joints[1].name_offset = 4; }},
      {"name_long", "joints: joint 1 has no name",
       [](M m) { m.skeleton.joints[1].name_bytes = ~0u; }},
      {"names_left", "joint_names: some", [](M m) { m.skeleton.names.push_back('x'); }},
      {"rest_nan", "joints: joint 1 has a rest",
       [](M m) { m.skeleton.joints[1].parent_from_joint.m[2][3] = kNan; }},
      {"scale_nan", "joints: joint 0 has a rest", [](M m) { m.skeleton.joints[0].scale.y = kNan; }},
      {"binding_past_end", "bone_bindings: bone 2 hangs",
       [](M m) { m.skeleton.bones[2].joint = 2; }},
      {"binding_nan", "bone_bindings: bone 0 has",
       [](M m) { m.skeleton.bones[0].joint_from_base.m[0][0] = kNan; }},
      {"cluster_past_end", "cluster_bones: cluster 1 follows",
       [](M m) { m.cluster_bones[1].bone = 3; }},
      {"cluster_nan", "cluster_bones: cluster 0 has",
       [](M m) { m.cluster_bones[0].local_from_base.m[0][0] = kNan; }},
  };
}

/// A sample, and a way to break it.
struct Case {
  ModelStorage (*sample)();
  Fault fault;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.fault.name; }

std::string case_name(const testing::TestParamInfo<Case>& info) { return info.param.fault.name; }

auto cases(ModelStorage (*sample)(), const std::vector<Fault>& faults) {
  std::vector<Case> cases;
  for (const Fault& fault : faults) cases.push_back({sample, fault});
  return testing::ValuesIn(cases);
}

class EveryFault : public testing::TestWithParam<Case> {};

TEST_P(EveryFault, IsFoundAndNamed) {
  const auto& [sample, fault] = GetParam();
  ModelStorage model = sample();
  ASSERT_EQ(find_inconsistency(model.view()), "");
  fault.make(model);
  EXPECT_THAT(find_inconsistency(model.view()), testing::StartsWith(fault.sentence));
}

INSTANTIATE_TEST_SUITE_P(Counts, EveryFault, cases(sample_model, count_faults()), case_name);
INSTANTIATE_TEST_SUITE_P(Motion, EveryFault, cases(sample_model, motion_faults()), case_name);
INSTANTIATE_TEST_SUITE_P(Links, EveryFault, cases(sample_model, link_faults()), case_name);
INSTANTIATE_TEST_SUITE_P(Look, EveryFault, cases(sample_model, appearance_faults()), case_name);
INSTANTIATE_TEST_SUITE_P(RigSizes, EveryFault, cases(sample_rig_model, rig_size_faults()),
                         case_name);
INSTANTIATE_TEST_SUITE_P(RigLinks, EveryFault, cases(sample_rig_model, rig_link_faults()),
                         case_name);
INSTANTIATE_TEST_SUITE_P(RigNumbers, EveryFault, cases(sample_rig_model, rig_number_faults()),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Quantized, EveryFault, cases(sample_quantized_model, quantized_faults()),
                         case_name);
INSTANTIATE_TEST_SUITE_P(Skeletons, EveryFault, cases(sample_skeleton_model, skeleton_faults()),
                         case_name);

TEST(FindInconsistency, AllowsNamesInAnyScript) {
  ModelStorage model = sample_model();
  model.clips[0].name = "ходьба 歩く 🚶 \xf4\x8f\xbf\xbf";
  EXPECT_EQ(find_inconsistency(model.view()), "");
}

TEST(SkeletonCheck, ASkeletonNeedsARigAndOneSegment) {
  const ModelStorage skeleton = sample_skeleton_model();
  ModelStorage model = sample_rig_model();  // of two segments
  model.skeleton = skeleton.skeleton;
  model.cluster_bones = skeleton.cluster_bones;
  EXPECT_THAT(find_inconsistency(model.view()), testing::StartsWith("segments: more than one"));
  model = skeleton;
  model.poses = {};
  EXPECT_THAT(find_inconsistency(model.view()), testing::StartsWith("joints: there"));
}

TEST(SkeletonFile, ASkeletonIsReadAsItWasWrittenAndCanBePosed) {
  const TempFolder folder;
  const std::string path = folder.file("posable.mdk");
  const ModelStorage written = sample_skeleton_model();
  write_mdk(written.view(), path);
  const MdkFile file(path);
  const SkeletonView& skeleton = file.model().skeleton;
  ASSERT_EQ(skeleton.joints.size(), 2u);
  EXPECT_EQ(skeleton.name(skeleton.joints[0]), "hip");
  EXPECT_EQ(skeleton.name(skeleton.joints[1]), "tail");
  EXPECT_EQ(skeleton.joints[1].parent_from_joint, written.skeleton.joints[1].parent_from_joint);
  EXPECT_EQ(skeleton.bones[2].joint, 1u);
  PosedMesh mesh(file.model());
  // Bone 1 stands one up, twice as large, and turns from x to y: strip 1 hangs on it.
  mesh.set_pose({{{}, {0, 0, 1.5}}, {0}});
  const Vec3f base = written.poses.rig.base_positions[7];
  const Vec3f p = mesh.positions()[7];
  EXPECT_NEAR(p.x, 2 * (base.x * std::cos(1.5) - base.y * std::sin(1.5)), 1e-5);
  EXPECT_NEAR(p.y, 1 + 2 * (base.x * std::sin(1.5) + base.y * std::cos(1.5)), 1e-5);
}

}  // namespace
}  // namespace mdk::test
