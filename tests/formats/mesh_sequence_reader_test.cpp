#include <gmock/gmock.h>

#include "common/base/parallel.h"
#include "formats/mesh/reader.h"
#include "tests/formats/expect_error.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class MeshSequence : public testing::Test {
 protected:
  /// A square whose second corner is at `height`.
  static std::string square(float height, const std::string& faces = "f 1 2 3 4\n") {
    return "v 0 0 0\nv 1 0 " + std::to_string(height) + "\nv 1 1 0\nv 0 1 0\n" + faces;
  }
  void put(int number, const std::string& text) {
    write_text(folder_.file("fold_" + std::to_string(number) + ".obj"), text);
  }
  ReadResult read(const ReadOptions& options = {}) {
    SilentProgress silent;
    return read_mesh_sequence(files_of_pattern(folder_.file("fold_####.obj")), options, silent);
  }

  TempFolder folder_;
};

TEST_F(MeshSequence, EveryFileIsAKeyInTheOrderOfTheNumbers) {
  for (int i = 1; i <= 40; ++i) put(i, square(0.125f * static_cast<float>(i)));
  const ReadResult result = read({8, {}, false});
  const PoseSequence& s = result.sequence;
  ASSERT_EQ(s.key_count(), 40u);
  EXPECT_THAT(s.clips, ElementsAre(Clip{"fold", 0, 40}));
  EXPECT_EQ(s.key_times[39], 39 / 8.0);
  for (std::uint32_t k = 0; k < 40; ++k)
    EXPECT_EQ(s.pose(k)[s.triangles[0].v[1]].z, 0.125f * static_cast<float>(k + 1));
  EXPECT_EQ(result.dependencies.size(), 40u);
  EXPECT_THAT(result.dependencies[1], HasSubstr("fold_2.obj"));
  EXPECT_THAT(result.notes, IsEmpty());
}

TEST_F(MeshSequence, AMissingNumberLeavesItsGapInTimeAndANote) {
  for (const int i : {5, 6, 9}) put(i, square(0));
  const ReadResult result = read({10, {}, false});
  EXPECT_THAT(result.sequence.key_times, ElementsAre(0, 0.1, 0.4));
  EXPECT_THAT(result.notes, ElementsAre(HasSubstr("missing, numbers 7 to 8;")));
}

TEST_F(MeshSequence, FilesWhoseNamesAreNoUtf8MakeAClipWhoseNameIs) {
  for (const char* number : {"1", "2"})
    write_text(folder_.file(std::string("k\xff\xfe_") + number + ".obj"), square(0));
  SilentProgress silent;
  const NumberedFiles files = files_of_pattern(folder_.file("k\xff\xfe_####.obj"));
  EXPECT_THAT(read_mesh_sequence(files, {}, silent).sequence.clips, ElementsAre(Clip{"k??", 0, 2}));
}

TEST_F(MeshSequence, TheFileWhoseFacesDifferIsNamed) {
  put(1, square(0));
  put(2, square(1));
  const auto refused = [&](const std::string& text, const std::string& words) {
    put(3, text);
    expect_error(ErrorCode::kBadInput, words, [&] { read(); });
    expect_error(ErrorCode::kBadInput, "fold_3.obj: ", [&] { read(); });
  };
  refused(square(0, "f 1 2 3\n"), "has 1 triangles where");
  refused("v 0 0 0\n" + square(0), "has 5 vertices where");
  refused(square(0, "f 2 3 4 1\n"), "its triangle 0 joins other vertices than that of");
  refused(square(0, "f 1 2 3\nf 1 3 2\n"), "its triangle 1 joins");
  refused(square(0, "f 1 2 3 9\n"), "line 5");
}

TEST_F(MeshSequence, OfSeveralBrokenFilesTheFirstIsReportedOnAnyNumberOfThreads) {
  for (int i = 1; i <= 20; ++i) put(i, i % 7 == 0 ? "f 1 2 3\n" : square(1));
  for (const int threads : {1, 4}) {
    const ThreadLimit limit(threads);
    expect_error(ErrorCode::kBadInput, "fold_7.obj", [&] { read(); });
  }
}

TEST_F(MeshSequence, ColoursAreThoseOfTheFirstFile) {
  const std::string rest = "v 1 0 0\nv 0 1 0\nf 1 2 3\n";
  put(1, "v 0 0 0 1 0 0\n" + rest);
  put(2, "v 0 0 1 1 0 0\n" + rest);
  EXPECT_THAT(read().sequence.appearance.corner_colors,
              ElementsAre(0xff0000ffu, 0xffffffffu, 0xffffffffu));
  EXPECT_THAT(read().notes, IsEmpty());
  put(3, "v 0 0 2 0 1 0\n" + rest);
  EXPECT_THAT(read().notes, ElementsAre(HasSubstr("vertex colours change over time")));
}

TEST_F(MeshSequence, OtherClipsThanItsOwnAreRefused) {
  put(1, square(0));
  EXPECT_EQ(read({30, {"fold"}, false}).sequence.key_count(), 1u);
  expect_error(ErrorCode::kUsage, "has one clip, \"fold\"", [&] { read({30, {"walk"}, false}); });
}

TEST_F(MeshSequence, CancellingLeavesNothingBehind) {
  class Stop final : public ProgressSink {
   public:
    void report(std::string_view, double fraction) override {
      if (fraction > 0.5) throw Error(ErrorCode::kUsage, "stopped");
    }
  } stop;
  for (int i = 1; i <= 40; ++i) put(i, square(0));
  expect_error(ErrorCode::kUsage, "stopped", [&] {
    read_mesh_sequence(files_of_pattern(folder_.file("fold_####.obj")), {}, stop);
  });
}

}  // namespace
}  // namespace mdk::test
