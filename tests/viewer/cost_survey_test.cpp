// Cost curves: measured from coarse to fine, kept per technique, begun anew where they would lie.
#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "formats/mdk/writer.h"
#include "tests/formats/temp_folder.h"
#include "tests/viewer/waving_bar.h"
#include "viewer/picture/requests.h"

namespace mdk::test {
namespace {

std::vector<double> evenly(std::size_t count) {
  std::vector<double> times(count);
  std::iota(times.begin(), times.end(), 0.0);
  return times;
}

TEST(CostCurves, AskForEveryMomentAsOftenAsThereArePasses) {
  for (const std::size_t count : {1u, 2u, 3u, 8u, 61u}) {
    CostCurves costs;
    costs.start(evenly(count));
    std::vector<int> asked(count, 0);
    while (const auto moment = costs.next_moment(3)) {
      ++asked[*moment];
      costs.add(3, *moment, 1);
    }
    EXPECT_EQ(asked, std::vector<int>(count, CostCurves::kPasses));
    EXPECT_EQ(costs.known(3), count);
    EXPECT_EQ(costs.known(2), 0u);
    EXPECT_TRUE(costs.next_moment(2));
  }
}

TEST(CostCurves, ShowTheWholeClipCoarselyBeforeItsDetails) {
  CostCurves costs;
  costs.start(evenly(65));
  for (int i = 0; i < 9; ++i) costs.add(0, *costs.next_moment(0), 1);
  std::set<std::size_t> known;
  for (std::size_t i = 0; i < 65; ++i)
    if (costs.curve(0)[i]) known.insert(i);
  EXPECT_EQ(known, (std::set<std::size_t>{0, 8, 16, 24, 32, 40, 48, 56, 64}));
}

TEST(CostCurves, KeepTheLeastOfSeveralTimes) {
  CostCurves costs;
  costs.start(evenly(2));
  costs.add(1, 0, 5);
  costs.add(1, 0, 3);
  costs.add(1, 0, 4);
  costs.add(1, 99, 1000);
  EXPECT_EQ(*costs.curve(1)[0], 3);
  EXPECT_EQ(costs.longest_ms(1), 3);
  EXPECT_TRUE(costs.curve(7).empty());
}

TEST(CostCurves, SpreadOverLongClipsFromEndToEnd) {
  CostCurves costs;
  costs.start(evenly(10001));
  EXPECT_EQ(costs.moments().size(), CostCurves::kMaxMoments);
  EXPECT_EQ(costs.moments().front(), 0);
  EXPECT_EQ(costs.moments().back(), 10000);
  costs.start({});
  EXPECT_FALSE(costs.next_moment(0));
}

class Surveying : public testing::Test {
 protected:
  Surveying() {
    const std::string path = folder_.file("bar.mdk");
    write_mdk(waving_bar().view(), path);
    picture_.file = std::make_shared<const MdkFile>(path);
    picture_.request.width = picture_.request.height = 16;
  }
  std::optional<RenderJob> next(std::uint32_t clip = 0) {
    return survey_.next(picture_, clip, {0, 0.1, 0.2}, costs_);
  }
  void finish(const RenderJob& job) {
    FinishedFrame frame;
    frame.job = job;
    frame.stats.trace_ms = 2;
    survey_.take(frame, costs_);
  }

  TempFolder folder_;
  RenderJob picture_;
  CostCurves costs_;
  CostSurvey survey_;
};

TEST_F(Surveying, GoesOnUntilTheCurveIsWhole) {
  int jobs = 0;
  while (auto job = next()) {
    ASSERT_TRUE(job->survey);
    finish(*job);
    ASSERT_LE(++jobs, 6);
  }
  EXPECT_EQ(jobs, 3 * CostCurves::kPasses);
  EXPECT_EQ(costs_.known(0), 3u);
}

TEST_F(Surveying, KeepsCurvesWhenTechniqueOrTimeChangeAndDropsThemWithTheView) {
  finish(*next());
  picture_.technique = 1;
  picture_.request.at = at_key(2);
  finish(*next());
  EXPECT_EQ(costs_.known(0), 1u);
  EXPECT_EQ(costs_.known(1), 1u);
  const RenderJob late = *next();
  picture_.request.camera.eye.x += 1;
  next();
  EXPECT_EQ(costs_.known(0), 0u);
  finish(late);  // of the old view
  EXPECT_EQ(costs_.known(1), 0u);
  finish(*next());
  EXPECT_EQ(costs_.known(1), 1u);
  next(1);  // another clip
  EXPECT_EQ(costs_.known(1), 0u);
}

}  // namespace
}  // namespace mdk::test
