// A jump in time costs what playing on costs: the work of a frame depends on its moment alone, not
// on the frames before it.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "common/trace/renderer.h"
#include "common/trace/technique.h"
#include "tests/viewer/waving_bar.h"

namespace mdk::test {
namespace {

constexpr std::size_t kMoments = 40;

/// The work of tracing each moment, in its own place, whatever the order they are visited in.
std::vector<TraceCounters> work_in_order(const ModelView& model, std::string_view technique,
                                         const std::vector<std::size_t>& order) {
  Renderer renderer(model, technique);
  FrameRequest request;
  request.width = request.height = 64;
  request.camera = {{1, 2, 9}, {0, 0, 0}, {0, 1, 0}, 40};
  request.counting = Counting::kOn;
  std::vector<TraceCounters> work(kMoments);
  for (const std::size_t i : order) {
    const double part = static_cast<double>(i) / (kMoments - 1);
    request.at = locate_time(model, 0, part * model.clip_seconds(model.clips[0]));
    work[i] = renderer.trace(request).counters;
  }
  return work;
}

TEST(RandomSeeks, DoTheSameWorkAsPlaying) {
  const ModelStorage bar = waving_bar();
  const ModelView model = bar.view();
  std::vector<std::size_t> playing(kMoments);
  std::iota(playing.begin(), playing.end(), std::size_t{0});
  std::vector<std::size_t> jumping = playing;
  std::shuffle(jumping.begin(), jumping.end(), std::mt19937(11));
  for (const char* technique : {"fuzzy-bvh", "fuzzy-kdtree", "static-kdtree", "rebuild-bvh",
                                "refit-bvh", "tsah-refit", "decomp-refit"}) {
    const auto played = work_in_order(model, technique, playing);
    EXPECT_EQ(work_in_order(model, technique, jumping), played) << technique;
    EXPECT_GT(played[0].node_visits + played[0].triangle_tests, 0u) << technique;
  }
}

}  // namespace
}  // namespace mdk::test
