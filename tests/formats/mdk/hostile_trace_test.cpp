// Damaged files that opening lets through are traced and shaded by every technique: whatever
// numbers they hold, nothing leaves its list (AddressSanitizer) and no hit names a triangle there
// is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <optional>

#include "common/base/parallel.h"
#include "common/trace/renderer.h"
#include "tests/formats/mdk/hostile_file.h"
#include "tests/formats/mdk/mdk_image.h"

namespace mdk::test {
namespace {

constexpr std::uint32_t kSide = 20;  // more than one tile

/// In front of the undamaged sample.
Camera sample_camera() { return fit_camera({{0, 0, 0}, {2, 5, 2}}, 1.0); }

std::uint32_t hits_in(const HitBuffer& hits, std::uint32_t triangles) {
  std::uint32_t count = 0;
  for (std::uint32_t y = 0; y < kSide; ++y) {
    for (std::uint32_t x = 0; x < kSide; ++x) {
      if (hits.triangle(x, y) == kNoHit) continue;
      EXPECT_LT(hits.triangle(x, y), triangles);
      ++count;
    }
  }
  return count;
}

/// Renders in all techniques and shadings; returns how many pixels were hit altogether.
std::uint32_t render_everything(const ModelStorage& storage) {
  const ModelView model = storage.view();
  std::uint32_t hits = 0;
  for (const TechniqueInfo& technique : technique_table()) {
    Renderer renderer(model, technique.id);
    const KeyInterval between =
        model.holds_between_keys ? KeyInterval{0, 1, 0.25f} : at_key(model.key_count() - 1);
    for (const KeyInterval& at : {at_key(model.rest_key), between}) {
      for (const ShadingInfo& shading : shading_table()) {
        const FrameRequest request{.at = at,
                                   .camera = sample_camera(),
                                   .width = kSide,
                                   .height = kSide,
                                   .shading = shading.mode};
        renderer.render(request);
      }
      hits += hits_in(renderer.hits(), model.triangle_count());
    }
  }
  return hits;
}

TEST(MdkHostileTrace, TheUndamagedSampleIsSeen) {
  HostileFile file;
  const std::optional<ModelStorage> model = file.open(file.bytes());
  ASSERT_TRUE(model.has_value());
  EXPECT_GT(render_everything(*model), 100u);
}

TEST(MdkHostileTrace, PositionsThatAreNoNumbersAtAllCanBeRendered) {
  HostileFile file;
  const ByteRange positions = file.ranges().back();
  ASSERT_EQ(positions.name, "POSE");
  for (const std::uint32_t word : extreme_words()) {
    Bytes damaged = file.bytes();
    for (std::size_t at = positions.begin; at < positions.end; at += 4) put(damaged, at, word);
    const std::optional<ModelStorage> model = file.open(damaged);
    ASSERT_TRUE(model.has_value()) << "opening does not look at positions";
    EXPECT_EQ(render_everything(*model), 0u) << "word " << word;
  }
}

TEST(MdkHostileTrace, BoundsOfAnySizeCanBeLit) {
  // Shadow rays start beyond the bounds; some tracers end the program where those lie too far out.
  for (const float far : {1e12f, 1e17f, 1e19f, 1e25f, 2.6e36f, 3e38f}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ModelStorage storage = sample_model();
      storage.bounds.lo[axis] = -far;
      storage.bounds.hi[axis] += axis == 0 ? far : 0.0f;
      const ModelView model = storage.view();
      for (const TechniqueInfo& technique : technique_table()) {
        Renderer renderer(model, technique.id);
        renderer.render({.at = at_key(model.rest_key),
                         .camera = sample_camera(),
                         .width = kSide,
                         .height = kSide,
                         .shading = ShadingMode::kLit});
        EXPECT_GT(hits_in(renderer.hits(), model.triangle_count()), 0u) << technique.id;
      }
    }
  }
}

/// The kind of poses whose samples a section is tried on.
PoseKind kind_of(const ByteRange& range) {
  static constexpr const char* kOfRig[] = {"BONE", "TGTW", "BASE", "BWFI", "BWGT", "MOFI", "MOFF"};
  if (std::ranges::find(kOfRig, range.name) != std::end(kOfRig)) return PoseKind::kRig;
  static constexpr const char* kOfQuantized[] = {"QERR", "QRUN", "QRES", "QBLK", "QBIT"};
  if (std::ranges::find(kOfQuantized, range.name) != std::end(kOfQuantized))
    return PoseKind::kQuantized;
  return PoseKind::kKeyPositions;
}

ModelStorage sample_of(PoseKind kind) {
  if (kind == PoseKind::kRig) return sample_rig_model();
  return kind == PoseKind::kQuantized ? sample_quantized_model() : sample_model();
}

class MdkHostileTraceOfPoses : public testing::TestWithParam<PoseKind> {};

TEST_P(MdkHostileTraceOfPoses, AnyDamageThatOpensCanBeRendered) {
  const ThreadLimit one_thread(1);  // the frames are tiny
  HostileFile file(sample_of(GetParam()));
  std::size_t refused = 0, rendered = 0;
  const auto words = extreme_words();
  std::size_t turn =
      0;  // goes through the extremes four at a time: all at every place take minutes
  for (const ByteRange& range : file.ranges()) {
    if (kind_of(range) != GetParam()) continue;
    for (std::size_t at = range.begin; at + 4 <= range.end; at += 4) {
      for (int i = 0; i < 4; ++i) {
        const std::uint32_t word = words[turn++ % words.size()];
        const auto model = file.open(file.with_word(at, word));
        if (!model) {
          ++refused;
          continue;
        }
        ++rendered;
        render_everything(*model);
        ASSERT_FALSE(testing::Test::HasFailure())
            << range.name << " byte " << at - range.begin << " word " << word;
      }
    }
  }
  std::printf("%zu refused, %zu rendered\n", refused, rendered);
  EXPECT_GT(rendered, refused / 2);
}

INSTANTIATE_TEST_SUITE_P(Kinds, MdkHostileTraceOfPoses,
                         testing::Values(PoseKind::kKeyPositions, PoseKind::kRig,
                                         PoseKind::kQuantized));

}  // namespace
}  // namespace mdk::test
