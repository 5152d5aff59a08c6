// Every way in which stored poses can be beyond decoding is found and named.
#include "formats/pose_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/formats/sample_model.h"

namespace mdk::test {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Fault {
  std::string name;
  std::string sentence;  ///< how it must begin
  std::function<void(ModelStorage&)> make;
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

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
      {"weights_none", "first_weight: the run of vertex 3",
       [](M m) { m.poses.rig.first_weight[4] = m.poses.rig.first_weight[3]; }},
      {"weights_fall", "first_weight: the run of vertex 4",
       [](M m) { m.poses.rig.first_weight[4] = ~0u; }},
      {"bone_past_end", "bone_weights: number 2 names bone 3 of 3",
       [](M m) { m.poses.rig.bone_weights[2].bone = 3; }},
      {"no_bones", "bone_weights: number 0 names bone 0 of 0",
       [](M m) { m.poses.rig.bone_maps.clear(); }},
      {"offsets_late", "first_offset: the runs do not cover",
       [](M m) { m.poses.rig.first_offset[0] = 1; }},
      {"offsets_fall", "first_offset: the run of vertex 2",
       [](M m) { m.poses.rig.first_offset[2] = 5; }},
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

class EveryPoseFault : public testing::TestWithParam<Fault> {};

TEST_P(EveryPoseFault, IsFoundAndNamed) {
  ModelStorage model = sample_rig_model();
  ASSERT_EQ(check_poses(model.view()), "");
  GetParam().make(model);
  EXPECT_THAT(check_poses(model.view()), testing::StartsWith(GetParam().sentence));
}

std::string fault_name(const testing::TestParamInfo<Fault>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Sizes, EveryPoseFault, testing::ValuesIn(rig_size_faults()), fault_name);
INSTANTIATE_TEST_SUITE_P(Links, EveryPoseFault, testing::ValuesIn(rig_link_faults()), fault_name);
INSTANTIATE_TEST_SUITE_P(Numbers, EveryPoseFault, testing::ValuesIn(rig_number_faults()),
                         fault_name);

}  // namespace
}  // namespace mdk::test
