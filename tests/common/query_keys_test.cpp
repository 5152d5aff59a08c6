// The clusters whose boxes a ray enters: none is missed, hardly any it passes is named, the nearest
// come first, on every instruction set.
#include "common/trace/query_keys.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "common/base/isa.h"
#include "common/motion/posed_mesh.h"
#include "tests/common/random_boxes.h"

namespace mdk {
namespace {

constexpr std::size_t kCounts[] = {1, 15, 16, 17, 80};
constexpr float kSide = 10;

class ResetIsa {
 public:
  ~ResetIsa() { reset_isa(); }
};

/// A model of nothing but clusters whose boxes move between two keys.
ModelStorage moving_clusters(std::size_t count, std::uint64_t seed) {
  ModelStorage storage;
  storage.clusters.resize(count);
  storage.key_times = {0, 1};
  storage.clips = {{"move", 0, 2}};
  for (const std::uint64_t key : {0, 1}) {
    const std::vector<Aabb> boxes = test::scattered_boxes(count, kSide, 3, 2 * seed + key);
    Aabb& whole = storage.key_boxes.emplace_back();
    for (const Aabb& box : boxes) whole.extend(box);
    for (const Aabb& box : boxes)
      storage.cluster_world_boxes.push_back(quantize_outward(box, whole));
  }
  return storage;
}

struct Line {
  Vec3d origin, direction;
};

Line random_line(test::Random& random) {
  const Aabb wide{{-kSide, -kSide, -kSide}, {2 * kSide, 2 * kSide, 2 * kSide}};
  const Aabb model{{0, 0, 0}, {kSide, kSide, kSide}};
  const Vec3d from = to_double(random.point(wide)), to = to_double(random.point(model));
  return {from, to - from};
}

/// Where a line enters a box that is grown by `margin`; infinity where it passes or enters late.
double entry(const Line& line, const Aabb& box, double margin, double t_max) {
  double near = 0, far = t_max;
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = (box.lo[k] - margin - line.origin[k]) / line.direction[k];
    const double b = (box.hi[k] + margin - line.origin[k]) / line.direction[k];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far ? near : std::numeric_limits<double>::infinity();
}

class EnterBoxes : public testing::TestWithParam<std::size_t> {};

TEST_P(EnterBoxes, FindsEveryBoxThatTheRayEntersAndHardlyAnyOther) {
  const ResetIsa reset;
  const std::size_t count = GetParam();
  const ModelStorage storage = moving_clusters(count, 7 + count);
  const ModelView model = storage.view();
  const BoxColumns columns(model);
  const Aabb bounds{{0, 0, 0}, {kSide + 3, kSide + 3, kSide + 3}};
  test::Random random(3);
  std::size_t entered = 0;
  for (int i = 0; i < 500; ++i) {
    const KeyInterval at =
        i % 3 == 0 ? at_key(i % 2) : KeyInterval{0, 1, static_cast<float>(random.unit())};
    const Line line = random_line(random);
    const BoxRay ray = make_box_ray({line.origin, line.direction}, Affine3d{}, bounds, 0);
    const float t_max = i % 2 == 0 ? std::numeric_limits<float>::infinity() : 0.5f;
    for (const std::string_view isa : available_isas()) {
      limit_isa(isa);
      std::vector<EnteredBox> named(count);
      named.resize(enter_boxes(ray, columns.at(at), t_max, named.data()));
      EXPECT_TRUE(std::ranges::is_sorted(named, {}, &EnteredBox::enter)) << isa;
      for (std::uint32_t c = 0; c < count; ++c) {
        const auto found = std::ranges::find(named, c, &EnteredBox::box);
        const Aabb box = cluster_world_box(model, c, at);
        const double enters = entry(line, box, 0, t_max);
        if (std::isfinite(enters)) {
          ++entered;
          ASSERT_NE(found, named.end()) << isa << ", line " << i << " enters box " << c;
          EXPECT_LE(found->enter, enters + 1e-6) << isa << ", line " << i;
        } else if (found != named.end()) {
          EXPECT_TRUE(std::isfinite(entry(line, box, 1e-3, t_max + 1e-3)))
              << isa << ", line " << i << " passes box " << c;
        }
      }
    }
  }
  EXPECT_GT(entered, 10u);
}

INSTANTIATE_TEST_SUITE_P(OfAnyNumber, EnterBoxes, testing::ValuesIn(kCounts));

}  // namespace
}  // namespace mdk
