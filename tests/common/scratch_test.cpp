// Large lists in files: what they hold, what they leave, and that each list goes by the space that
// it was given.
#include "common/base/scratch.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <new>
#include <numeric>
#include <string>
#include <utility>

#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::IsEmpty;

constexpr std::size_t kBlock = std::size_t{1} << 20;

TEST(Scratch, LargeListsStandInFilesThatHaveNoNameAndSmallOnesDoNot) {
  const TempFolder folder;
  ScratchList<int> kept;
  {
    const ScratchSpace scratch(folder.path(), kBlock);
    const ScratchList<int> small(kBlock / sizeof(int) - 1, scratch);
    EXPECT_EQ(scratch.peak_bytes(), 0u);
    kept = ScratchList<int>(scratch);
    kept.resize(4 * kBlock / sizeof(int));
    EXPECT_EQ(scratch.peak_bytes(), 4 * kBlock);
    EXPECT_THAT(folder.names(), IsEmpty());
    std::iota(kept.begin(), kept.end(), 7);
  }
  for (std::size_t i = 0; i < kept.size(); ++i) ASSERT_EQ(kept[i], 7 + static_cast<int>(i));
}

TEST(Scratch, AListGoesByTheSpaceThatItWasGivenAndTakesItAlong) {
  const TempFolder folder;
  const ScratchSpace scratch(folder.path(), kBlock);
  const ScratchList<char> elsewhere(4 * kBlock);
  EXPECT_EQ(scratch.peak_bytes(), 0u) << "another list has nothing to do with it";
  ScratchList<char> list(2 * kBlock, 'a', scratch);
  ScratchList<char> moved;
  moved = std::move(list);
  EXPECT_EQ(scratch.peak_bytes(), 2 * kBlock) << "what is moved stays where it is";
  const ScratchList<char> copy = moved;
  EXPECT_EQ(scratch.peak_bytes(), 4 * kBlock);
  EXPECT_EQ(copy, moved);
  moved = elsewhere;
  EXPECT_EQ(moved.get_allocator().space(), ScratchSpace());
}

/// Lets this process have no more private memory than it has now, and a little.
class NoMoreMemory {
 public:
  NoMoreMemory() {
    ::getrlimit(RLIMIT_DATA, &old_);
    const rlimit limit{8 * kBlock, old_.rlim_max};
    ::setrlimit(RLIMIT_DATA, &limit);
  }
  ~NoMoreMemory() { ::setrlimit(RLIMIT_DATA, &old_); }
  NoMoreMemory(const NoMoreMemory&) = delete;
  NoMoreMemory& operator=(const NoMoreMemory&) = delete;

 private:
  rlimit old_{};
};

TEST(Scratch, TheyDoNotCountAsMemoryAndAFolderThatIsNotThereGivesNone) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "a sanitizer takes more than the limit";
  const TempFolder folder;
  const auto take = [](const std::string& place) {
    const ScratchSpace scratch(place, kBlock);
    const NoMoreMemory limit;
    try {
      const ScratchList<char> large(64 * kBlock, scratch);
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  };
  EXPECT_TRUE(take(folder.path()));
  EXPECT_FALSE(take(folder.file("nowhere")));
}

}  // namespace
}  // namespace mdk::test
