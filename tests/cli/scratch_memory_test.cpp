// Long lists in files: what they hold, what they leave, and that a bake of more keys than its limit
// allows gives the same bytes.
#include "preprocess/cli/scratch_memory.h"

#include <gmock/gmock.h>
#include <sys/resource.h>

#include <cmath>
#include <new>
#include <numeric>
#include <string>
#include <vector>

#include "tests/cli/program_run.h"
#include "tests/formats/point_cache_builder.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::IsEmpty;

constexpr std::size_t kBlock = std::size_t{1} << 20;

TEST(ScratchMemory, LargeListsStandInFilesThatHaveNoNameAndSmallOnesDoNot) {
  const TempFolder folder;
  std::vector<int> kept;
  {
    const ScratchMemory scratch(folder.path(), kBlock);
    const std::uint64_t before = ScratchMemory::peak_bytes();
    const std::vector<int> small(kBlock / sizeof(int) - 1);
    EXPECT_EQ(ScratchMemory::peak_bytes(), before);
    kept.resize(4 * kBlock / sizeof(int));
    EXPECT_GE(ScratchMemory::peak_bytes(), before + 4 * kBlock);
    EXPECT_THAT(folder.names(), IsEmpty());
    std::iota(kept.begin(), kept.end(), 7);
  }
  for (std::size_t i = 0; i < kept.size(); ++i) ASSERT_EQ(kept[i], 7 + static_cast<int>(i));
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

TEST(ScratchMemory, TheyDoNotCountAsMemoryAndAFolderThatIsNotThereGivesNone) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "a sanitizer takes more than the limit";
  const TempFolder folder;
  const auto take = [](const std::string& place) {
    const ScratchMemory scratch(place, kBlock);
    const NoMoreMemory limit;
    try {
      const std::vector<char> large(64 * kBlock);
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
  };
  EXPECT_TRUE(take(folder.path()));
  EXPECT_FALSE(take(folder.file("nowhere")));
}

/// A grid that waves: more bytes of keys than the limit below.
void write_wave(const TempFolder& folder, int side, std::uint32_t keys) {
  std::string mesh;
  const auto number = [](int i) { return std::to_string(i) + " "; };
  for (int i = 0; i < side * side; ++i) mesh += "v " + number(i % side) + number(i / side) + "0\n";
  for (int y = 0; y + 1 < side; ++y)
    for (int x = 0; x + 1 < side; ++x) {
      const int a = y * side + x + 1;
      mesh += "f " + number(a) + number(a + 1) + number(a + side + 1) + number(a + side) + "\n";
    }
  write_text(folder.file("wave.obj"), mesh);
  std::vector<Vec3f> points;
  for (std::uint32_t key = 0; key < keys; ++key)
    for (int i = 0; i < side * side; ++i) {
      const auto x = static_cast<float>(i % side), y = static_cast<float>(i / side);
      points.push_back({x, y, std::sin(0.1f * x + 0.3f * static_cast<float>(key))});
    }
  write_bytes(folder.file("wave.pc2"), pc2_bytes(keys, points));
}

TEST(ScratchMemory, ABakeOfMoreKeysThanItsLimitHoldsGivesTheSameBytes) {
  if (std::string(MDK_SANITIZE) != "") GTEST_SKIP() << "a sanitizer takes more than the limit";
  const TempFolder folder;
  write_wave(folder, 100, 600);  // 72 MB of keys
  const auto bake = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"bake",
                                      folder.file("wave.obj"),
                                      folder.file("wave.pc2"),
                                      "-o",
                                      folder.file(name),
                                      "--decompose",
                                      "none",
                                      "--segments",
                                      "1",
                                      "-q"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_mdprep(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
  };
  bake("free.mdk", {});
  bake("held.mdk", {"--memory-limit", "64M"});
  EXPECT_TRUE(read_bytes(folder.file("held.mdk")) == read_bytes(folder.file("free.mdk")));
  EXPECT_THAT(folder.names(), testing::ElementsAre("free.mdk", "held.mdk", "wave.obj", "wave.pc2"));
}

}  // namespace
}  // namespace mdk::test
