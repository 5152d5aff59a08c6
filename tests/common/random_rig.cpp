#include "tests/common/random_rig.h"

#include <random>

namespace mdk {

Rig random_rig(const RigSize& size, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> number(-10, 10), share(0.1f, 1);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  Rig rig;
  rig.first_weight = {0};
  if (size.targets > 0) rig.first_offset = {0};
  for (std::uint32_t v = 0; v < size.vertices; ++v) {
    rig.base_positions.push_back({number(random), number(random), number(random)});
    const std::uint32_t weights = 1 + below(4);
    float left = 1;
    for (std::uint32_t i = 0; i < weights; ++i) {
      const float weight = i + 1 == weights ? left : left * share(random);
      rig.bone_weights.push_back({below(size.bones), weight});
      left -= weight;
    }
    rig.first_weight.push_back(static_cast<std::uint32_t>(rig.bone_weights.size()));
    if (size.targets == 0) continue;
    for (std::uint32_t i = below(3); i > 0; --i)
      rig.morph_offsets.push_back(
          {below(size.targets), {number(random), number(random), number(random)}});
    rig.first_offset.push_back(static_cast<std::uint32_t>(rig.morph_offsets.size()));
  }
  rig.bone_maps.resize(size.keys * size.bones);
  for (Affine3f& map : rig.bone_maps)
    for (auto& row : map.m)
      for (float& entry : row) entry = number(random);
  for (std::uint32_t i = 0; i < size.keys * size.targets; ++i)
    rig.target_weights.push_back(share(random));
  return rig;
}

}  // namespace mdk
