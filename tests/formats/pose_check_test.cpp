// Every way in which stored poses can be beyond decoding is found and named.
#include "formats/pose_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/formats/fault.h"
#include "tests/formats/sample_model.h"

namespace mdk::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

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
      {"rig_beside_positions", "base_positions: a rig is there",
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
      {"of_another_kind", "quantized_blocks: there",
       [](ModelStorage& m) { m.poses.kind = PoseKind::kKeyPositions; }},
      fault("no_error", "quantization_error: 0 of them, not 1", [](Q q) { q.error.clear(); }),
      fault("error_past_bound", "quantization_error: the largest",
            [](Q q) { q.error[0].largest = 2 * q.error[0].bound; }),
      fault("error_nan", "quantization_error: the largest",
            [](Q q) { q.error[0].largest = static_cast<double>(kNan); }),
      fault("no_runs", "first_vertex: the runs do not cover", [](Q q) { q.first_vertex.clear(); }),
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

std::string fault_after(ModelStorage model, const Fault& fault) {
  EXPECT_EQ(check_poses(model.view()), "");
  fault.make(model);
  return check_poses(model.view());
}

class EveryPoseFault : public testing::TestWithParam<Fault> {};

TEST_P(EveryPoseFault, IsFoundAndNamed) {
  EXPECT_THAT(fault_after(sample_rig_model(), GetParam()),
              testing::StartsWith(GetParam().sentence));
}

class EveryQuantizedFault : public testing::TestWithParam<Fault> {};

TEST_P(EveryQuantizedFault, IsFoundAndNamed) {
  EXPECT_THAT(fault_after(sample_quantized_model(), GetParam()),
              testing::StartsWith(GetParam().sentence));
}

INSTANTIATE_TEST_SUITE_P(All, EveryQuantizedFault, testing::ValuesIn(quantized_faults()),
                         fault_name);
INSTANTIATE_TEST_SUITE_P(Sizes, EveryPoseFault, testing::ValuesIn(rig_size_faults()), fault_name);
INSTANTIATE_TEST_SUITE_P(Links, EveryPoseFault, testing::ValuesIn(rig_link_faults()), fault_name);
INSTANTIATE_TEST_SUITE_P(Numbers, EveryPoseFault, testing::ValuesIn(rig_number_faults()),
                         fault_name);

}  // namespace
}  // namespace mdk::test
