// What is asked of the worker, what it gives back, and at which resolution.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <limits>
#include <thread>

#include "common/trace/technique.h"
#include "formats/mdk/writer.h"
#include "tests/viewer/waving_bar.h"
#include "viewer/picture/render_worker.h"
#include "viewer/picture/requests.h"

namespace mdk {
namespace {

using Situation = RequestPolicy::Situation;

RenderJob job_at(std::uint32_t key) {
  RenderJob job;
  job.request.at = at_key(key);
  return job;
}

TEST(RequestPolicy, AsksOnceForEachPicture) {
  RequestPolicy policy;
  EXPECT_TRUE(policy.next(job_at(0), {}));
  EXPECT_FALSE(policy.next(job_at(0), {}));
  EXPECT_TRUE(policy.next(job_at(1), {}));
  RenderJob other_technique = job_at(1);
  other_technique.technique = 1;
  EXPECT_TRUE(policy.next(other_technique, {}));
  EXPECT_FALSE(policy.next(other_technique, {}));
}

TEST(RequestPolicy, AsksForAChangeAlthoughTheWorkerIsBusy) {
  RequestPolicy policy;
  EXPECT_TRUE(policy.next(job_at(0), {}));
  EXPECT_TRUE(policy.next(job_at(1), {.worker_busy = true}));
}

TEST(RequestPolicy, KeepsTracingOnlyWhenToldAndWhenTheWorkerIsFree) {
  RequestPolicy policy;
  policy.next(job_at(0), {});
  EXPECT_FALSE(policy.next(job_at(0), {.worker_busy = true, .keep_tracing = true}));
  EXPECT_TRUE(policy.next(job_at(0), {.keep_tracing = true}));
}

TEST(RequestPolicy, CountsOnceAtRestAfterATimedFrame) {
  RequestPolicy policy;
  policy.next(job_at(0), {});
  const auto counting = policy.next(job_at(0), {.now = 5, .count_work = true});
  ASSERT_TRUE(counting);
  EXPECT_EQ(counting->request.counting, Counting::kOn);
  EXPECT_FALSE(policy.next(job_at(0), {.now = 6, .count_work = true}));
}

TEST(RequestPolicy, TimesAPictureThatWasFirstCounted) {
  RequestPolicy policy;
  const auto counting = policy.next(job_at(0), {.now = 5, .count_work = true});
  ASSERT_TRUE(counting);
  EXPECT_EQ(counting->request.counting, Counting::kOn);
  const auto timed = policy.next(job_at(0), {.now = 5.1, .count_work = true});
  ASSERT_TRUE(timed);
  EXPECT_EQ(timed->request.counting, Counting::kOff);
  EXPECT_FALSE(policy.next(job_at(0), {.now = 6, .count_work = true}));
}

TEST(RequestPolicy, CountsNowAndThenWhilePicturesChange) {
  RequestPolicy policy;
  int counting = 0;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const auto job = policy.next(job_at(i), {.now = 0.02 * i, .count_work = true});
    ASSERT_TRUE(job);
    counting += job->request.counting == Counting::kOn;
  }
  EXPECT_EQ(counting, 4);  // two seconds, one every half
}

TEST(RequestPolicy, DoesNotRepeatWhatFailedUntilItChanges) {
  RequestPolicy policy;
  policy.next(job_at(0), {});
  policy.note_failure();
  EXPECT_FALSE(policy.next(job_at(0), {.keep_tracing = true}));
  EXPECT_TRUE(policy.next(job_at(1), {}));
  EXPECT_FALSE(policy.failed());
}

TEST(Resolution, IsCoarseOnlyWhileDraggingWouldBeLate) {
  const double late = 1000;
  EXPECT_EQ(picture_divisor(Resolution::kFull, Motion::kDragging, late), 1u);
  EXPECT_EQ(picture_divisor(Resolution::kHalf, Motion::kStill, 1), 2u);
  EXPECT_EQ(picture_divisor(Resolution::kQuarter, Motion::kStill, 1), 4u);
  EXPECT_EQ(picture_divisor(Resolution::kAuto, Motion::kStill, late), 1u);
  EXPECT_EQ(picture_divisor(Resolution::kAuto, Motion::kDragging, 5), 1u);
  EXPECT_EQ(picture_divisor(Resolution::kAuto, Motion::kDragging, 100), 2u);
  EXPECT_EQ(picture_divisor(Resolution::kAuto, Motion::kDragging, late), 4u);
}

class RenderWorkerTest : public testing::Test {
 protected:
  RenderWorkerTest() {
    const std::string path = testing::TempDir() + "mdview_worker_" +
                             testing::UnitTest::GetInstance()->current_test_info()->name() + ".mdk";
    write_mdk(test::waving_bar().view(), path);
    file_ = std::make_shared<const MdkFile>(path);
    std::filesystem::remove(path);  // the mapping stays
    job_.file = file_;
    job_.request.width = 96;
    job_.request.height = 64;
    job_.request.camera = fit_camera(file_->model().bounds, 1.5);
  }

  static FinishedFrame wait_for_frame(RenderWorker& worker) {
    for (int i = 0; i < 6000; ++i) {
      if (auto frame = worker.take_finished()) return std::move(*frame);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "no frame came";
    return {};
  }

  std::shared_ptr<const MdkFile> file_;
  RenderJob job_;
};

TEST_F(RenderWorkerTest, GivesThePictureARendererGivesByEveryTechnique) {
  std::atomic<int> finished = 0;
  RenderWorker worker([&] { ++finished; });
  for (std::size_t row = 0; row < technique_table().size(); ++row) {
    job_.technique = row;
    job_.request.at = locate_time(file_->model(), 0, 0.23);
    Renderer renderer(file_->model(), technique_table()[row].id);
    renderer.render(job_.request);
    worker.request(job_);
    const FinishedFrame frame = wait_for_frame(worker);
    EXPECT_EQ(frame.error, "");
    EXPECT_TRUE(same_picture(frame.job, job_));
    EXPECT_EQ(frame.pixels,
              std::vector<std::uint32_t>(renderer.pixels().begin(), renderer.pixels().end()));
    EXPECT_GT(frame.stats.hits, 0u);
  }
  EXPECT_EQ(finished, static_cast<int>(technique_table().size()));
}

TEST_F(RenderWorkerTest, TheLatestRequestIsTheLastPicture) {
  RenderWorker worker([] {});
  for (std::uint32_t key = 0; key < file_->model().key_count(); ++key) {
    job_.request.at = at_key(key);
    worker.request(job_);
  }
  while (worker.busy()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  const FinishedFrame frame = wait_for_frame(worker);
  EXPECT_EQ(frame.job.request.at, job_.request.at);
  EXPECT_FALSE(worker.take_finished());
}

TEST_F(RenderWorkerTest, SaysInASentenceWhatCannotBeRenderedAndGoesOn) {
  RenderWorker worker([] {});
  RenderJob impossible = job_;
  impossible.request.camera.vertical_fov_deg = std::numeric_limits<float>::quiet_NaN();
  worker.request(impossible);
  const FinishedFrame failed = wait_for_frame(worker);
  EXPECT_NE(failed.error, "");
  EXPECT_TRUE(failed.pixels.empty());
  worker.request(job_);
  EXPECT_EQ(wait_for_frame(worker).error, "");
}

TEST_F(RenderWorkerTest, CanBeDestroyedWhileItWorks) {
  for (int i = 0; i < 20; ++i) {
    RenderWorker worker([] {});
    worker.request(job_);
  }
}

TEST_F(RenderWorkerTest, OnlyWhatNobodyWaitsForIsOutdated) {
  RenderJob other = job_;
  EXPECT_FALSE(outdates(other, job_));
  other.request.at = at_key(2);
  other.request.camera.eye.x += 1;
  other.request.shading = ShadingMode::kNormals;
  other.request.width *= 2;
  EXPECT_FALSE(outdates(other, job_));
  EXPECT_TRUE(outdates(job_, other)) << "coarser";

  other = job_;
  other.technique = 1;
  EXPECT_TRUE(outdates(other, job_));
  other = job_;
  other.against = 1;
  EXPECT_TRUE(outdates(other, job_));
  other = job_;
  other.file.reset();
  EXPECT_TRUE(outdates(other, job_));
  other = job_;
  other.survey = SurveyMark{};
  EXPECT_TRUE(outdates(job_, other));
  EXPECT_FALSE(outdates(other, job_));
}

/// Takes minutes: the bar fills it, and each pixel looks about by brute force.
RenderJob endless(RenderJob job) {
  for (std::size_t row = 0; row < technique_table().size(); ++row)
    if (technique_table()[row].id == "brute-force") job.technique = row;
  job.request.width = job.request.height = 4096;
  job.request.shading = ShadingMode::kLit;
  job.request.occlusion_rays = 64;
  return job;
}

TEST_F(RenderWorkerTest, LeavesOffALatePictureWhereAnotherTechniqueIsAskedFor) {
  RenderWorker worker([] {});
  worker.request(endless(job_));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(worker.busy());
  worker.request(job_);
  const FinishedFrame frame = wait_for_frame(worker);
  EXPECT_TRUE(same_picture(frame.job, job_));
  EXPECT_EQ(frame.error, "");
  EXPECT_GT(frame.stats.hits, 0u);
}

TEST_F(RenderWorkerTest, DoesNotWaitForALatePictureWhenItEnds) {
  RenderWorker worker([] {});
  worker.request(endless(job_));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(worker.busy());
}

}  // namespace
}  // namespace mdk
