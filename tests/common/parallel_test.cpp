#include "common/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace mdk {
namespace {

TEST(Parallel, ChunksCoverTheRangeOnceAndAreTheSameForAnyThreadCount) {
  std::vector<std::set<std::pair<std::size_t, std::size_t>>> seen;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    std::mutex mutex;
    std::set<std::pair<std::size_t, std::size_t>> chunks;
    std::vector<int> visits(1003, 0);
    parallel_chunks(visits.size(), 10, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++visits[i];
      const std::lock_guard lock(mutex);
      chunks.emplace(begin, end);
    });
    for (const int count : visits) EXPECT_EQ(count, 1);
    seen.push_back(chunks);
  }
  EXPECT_EQ(seen[0], seen[1]);
  EXPECT_EQ(seen[0], seen[2]);
}

TEST(Parallel, EmptyRangeCallsNothingAndExceptionsArePassedOn) {
  parallel_chunks(0, 10, [](std::size_t, std::size_t) { FAIL(); });
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    EXPECT_THROW(parallel_chunks(100, 1,
                                 [](std::size_t i, std::size_t) {
                                   if (i == 57) throw std::runtime_error("57");
                                 }),
                 std::runtime_error);
  }
}

std::atomic<int> calls_left;

TEST(Parallel, ACheckEndsALoopBeforeItsNextChunkWhileItLives) {
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    std::atomic<int> chunks = 0;
    const auto loop = [&] {
      parallel_chunks(1000, 1, [&](std::size_t, std::size_t) { ++chunks; });
    };
    calls_left = 20;
    {
      const LoopCheck check([] {
        if (--calls_left < 0) throw std::runtime_error("told to stop");
      });
      EXPECT_THROW(loop(), std::runtime_error);
      EXPECT_EQ(chunks, 20);
      EXPECT_THROW(check_loop(), std::runtime_error);
    }
    loop();
    EXPECT_EQ(chunks, 1020);
  }
}

TEST(Parallel, ACheckHoldsForLoopsWithinLoopsAndForNoOtherThread) {
  const ThreadLimit limit(4);
  std::atomic<int> checks = 0;
  const auto nested = [] {
    parallel_chunks(8, 1, [](std::size_t, std::size_t) {
      parallel_chunks(8, 1, [](std::size_t, std::size_t) {});
    });
  };
  {
    const LoopCheck check([&] { ++checks; });
    std::thread(nested).join();
    EXPECT_EQ(checks, 0);
    nested();
    EXPECT_EQ(checks, 8 + 8 * 8);
  }
  nested();
  EXPECT_EQ(checks, 8 + 8 * 8);
}

TEST(Parallel, ThreadLimitHolds) {
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(thread_count(), 1);
    const ThreadLimit more(4);
    EXPECT_EQ(thread_count(), 1);
  }
  const ThreadLimit limit(0);
  EXPECT_GE(thread_count(), 1);
}

TEST(Parallel, ALimitHoldsForTheLoopsOfItsThreadAndForNoOther) {
  const int all = thread_count();
  const ThreadLimit limit(1);
  int elsewhere = 0;
  std::thread([&] { elsewhere = thread_count(); }).join();
  EXPECT_EQ(elsewhere, all);
  EXPECT_EQ(thread_count(), 1);
}

TEST(Parallel, ALimitHoldsForLoopsWithinLoopsOnAnyThread) {
  for (const int threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    std::mutex mutex;
    std::set<std::thread::id> seen;
    std::atomic<int> wrong = 0;
    parallel_chunks(64, 1, [&](std::size_t, std::size_t) {
      parallel_chunks(16, 1, [&](std::size_t, std::size_t) {
        wrong += thread_count() != threads ? 1 : 0;
        const std::lock_guard lock(mutex);
        seen.insert(std::this_thread::get_id());
      });
    });
    EXPECT_EQ(wrong, 0);
    EXPECT_LE(seen.size(), static_cast<std::size_t>(threads));
  }
}

}  // namespace
}  // namespace mdk
