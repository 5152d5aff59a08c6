#include "tests/viewer/waving_bar.h"

#include <cmath>
#include <numbers>

#include "preprocess/pipeline.h"

namespace mdk::test {
namespace {

constexpr std::uint32_t kSides = 4;

// A square bar along +y, open at both ends.
void add_triangles(PoseSequence& sequence, std::uint32_t rings) {
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring)
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const std::uint32_t a = ring * kSides + side, b = ring * kSides + (side + 1) % kSides;
      sequence.triangles.push_back({{a, a + kSides, b}});
      sequence.triangles.push_back({{b, a + kSides, b + kSides}});
    }
}

// The rings above the middle turn about it by `angle`.
void add_pose(PoseSequence& sequence, std::uint32_t rings, double angle) {
  constexpr double kX[kSides] = {-0.3, 0.3, 0.3, -0.3}, kZ[kSides] = {0.3, 0.3, -0.3, -0.3};
  for (std::uint32_t ring = 0; ring < rings; ++ring)
    for (std::uint32_t side = 0; side < kSides; ++side) {
      const double x = kX[side], y = 4.0 * ring / (rings - 1) - 2;
      const double turn = y > 0 ? angle : 0;
      sequence.positions.push_back({static_cast<float>(x * std::cos(turn) - y * std::sin(turn)),
                                    static_cast<float>(x * std::sin(turn) + y * std::cos(turn)),
                                    static_cast<float>(kZ[side])});
    }
}

void add_clip(PoseSequence& sequence, std::uint32_t rings, const char* name, std::uint32_t keys) {
  sequence.clips.push_back({name, sequence.key_count(), keys});
  for (std::uint32_t key = 0; key < keys; ++key) {
    sequence.key_times.push_back(0.1 * key);
    add_pose(sequence, rings, std::sin(2 * std::numbers::pi * key / (keys - 1)));
  }
}

}  // namespace

ModelStorage waving_bar(std::uint32_t rings) {
  PoseSequence sequence;
  sequence.vertex_count = rings * kSides;
  add_triangles(sequence, rings);
  add_clip(sequence, rings, "wave", 11);
  add_clip(sequence, rings, "nod", 5);
  sequence.appearance.materials.push_back({});
  sequence.appearance.triangle_materials.assign(sequence.triangles.size(), 0);
  SilentProgress silent;
  return decompose(std::move(sequence), {}, silent).model;
}

}  // namespace mdk::test
