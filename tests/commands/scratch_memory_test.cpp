// A bake of more keys than its limit of memory allows gives the same bytes.
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/commands/program_run.h"
#include "tests/formats/point_cache_builder.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

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
