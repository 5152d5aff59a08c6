#include "formats/mesh/numbered_files.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "tests/formats/expect_error.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;

class NumberedFilesTest : public testing::Test {
 protected:
  void touch(const std::vector<std::string>& names) {
    for (const std::string& name : names) write_text(folder_.file(name), "");
  }
  std::vector<std::string> names(const NumberedFiles& sequence) const {
    std::vector<std::string> all;
    for (const std::string& file : sequence.files) {
      const std::filesystem::path path(file);
      EXPECT_EQ(path.parent_path().string(), folder_.path());
      all.push_back(path.filename().string());
    }
    return all;
  }
  NumberedFiles in_folder() const {
    constexpr std::string_view kExtensions[] = {".obj", ".ply"};
    return numbered_files_in(folder_.path(), kExtensions);
  }

  TempFolder folder_;
};

TEST_F(NumberedFilesTest, NumbersAreTheLastDigitsBeforeTheExtension) {
  const auto parts = numbered_name("take2_walk_0012_high.v.obj");
  ASSERT_TRUE(parts);
  EXPECT_EQ(parts->before, "take2_walk_");
  EXPECT_EQ(parts->number, 12u);
  EXPECT_EQ(parts->after, "_high.v.obj");
  EXPECT_FALSE(numbered_name("walk.mp4")) << "digits of the extension are no number";
  EXPECT_FALSE(numbered_name("walk_1234567890123456.obj")) << "no frame has such a number";
}

TEST_F(NumberedFilesTest, AFolderGivesItsFilesInTheOrderOfTheirNumbers) {
  touch({"1.obj", "10.OBJ.txt", "10.obj", "2.obj", "readme.txt", "mesh.obj", "._3.obj"});
  const NumberedFiles sequence = in_folder();
  EXPECT_THAT(names(sequence), ElementsAre("1.obj", "2.obj", "10.obj"));
  EXPECT_THAT(sequence.numbers, ElementsAre(1u, 2u, 10u));
  EXPECT_EQ(sequence.name, std::filesystem::path(folder_.path()).filename().string());
}

TEST_F(NumberedFilesTest, AFolderOfNoneOrSeveralSequencesIsRefused) {
  expect_error(ErrorCode::kBadInput, "without numbered", [&] { in_folder(); });
  touch({"walk_1.obj", "walk_2.obj", "run_1.obj"});
  expect_error(ErrorCode::kBadInput, "more than one sequence ('run_####.obj', 'walk_####.obj')",
               [&] { in_folder(); });
  expect_error(ErrorCode::kIo, "none", [&] { numbered_files_in(folder_.file("none"), {}); });
}

TEST_F(NumberedFilesTest, APatternTakesNumbersOfAnyLengthAndNothingElse) {
  touch({"walk_0009.ply", "walk_0010.ply", "walk_11.ply", "walk_x.ply", "walk_.ply", "walk_9b.ply",
         "walk_0012.obj", "a_walk_0013.ply"});
  ASSERT_TRUE(is_number_pattern(folder_.file("walk_####.ply")));
  const NumberedFiles sequence = files_of_pattern(folder_.file("walk_####.ply"));
  EXPECT_THAT(names(sequence), ElementsAre("walk_0009.ply", "walk_0010.ply", "walk_11.ply"));
  EXPECT_EQ(sequence.name, "walk");
  expect_error(ErrorCode::kIo, "run_#.ply: there is no file",
               [&] { files_of_pattern(folder_.file("run_#.ply")); });
}

TEST_F(NumberedFilesTest, AFileThatIsReallyCalledLikeAPatternIsNone) {
  touch({"c#.obj"});
  EXPECT_FALSE(is_number_pattern(folder_.file("c#.obj")));
  EXPECT_FALSE(is_number_pattern(folder_.file("walk.obj")));
}

TEST_F(NumberedFilesTest, TwoFilesOfOneNumberAreRefused) {
  touch({"walk_1.obj", "walk_01.obj"});
  expect_error(ErrorCode::kBadInput, "has the same number as",
               [&] { files_of_pattern(folder_.file("walk_#.obj")); });
}

TEST_F(NumberedFilesTest, AFirstFileIsFollowedWhereTheNextNumberIsThere) {
  touch({"1.obj", "2.obj", "3.obj", "7.obj", "9.obj", "plain.obj"});
  EXPECT_THAT(names(files_from(folder_.file("2.obj"))),
              ElementsAre("2.obj", "3.obj", "7.obj", "9.obj"));
  EXPECT_THAT(names(files_from(folder_.file("7.obj"))), ElementsAre("7.obj"));
  EXPECT_THAT(names(files_from(folder_.file("9.obj"))), ElementsAre("9.obj"));
  EXPECT_THAT(names(files_from(folder_.file("plain.obj"))), ElementsAre("plain.obj"));
  EXPECT_THAT(names(files_from(folder_.file("none_1.obj"))), ElementsAre("none_1.obj"));
}

TEST_F(NumberedFilesTest, AListIsSortedWhereItIsNumberedAndKeptWhereItIsNot) {
  const std::vector<std::string> shell = {"d/w1.obj", "d/w10.obj", "d/w2.obj"};
  EXPECT_THAT(listed_files(shell).files, ElementsAre("d/w1.obj", "d/w2.obj", "d/w10.obj"));
  EXPECT_THAT(listed_files(shell).numbers, ElementsAre(1u, 2u, 10u));
  EXPECT_EQ(listed_files(shell).name, "w");
  for (const std::vector<std::string>& other : {std::vector<std::string>{"up.obj", "down.obj"},
                                                {"b2.obj", "a1.obj"},
                                                {"e/1.obj", "d/0.obj"}}) {
    EXPECT_EQ(listed_files(other).files, other);
    EXPECT_THAT(listed_files(other).numbers, ElementsAre(0u, 1u));
  }
  const std::vector<std::string> twice = {"a1.obj", "a2.obj", "a1.obj"};
  expect_error(ErrorCode::kUsage, "a1.obj: is named twice", [&] { listed_files(twice); });
}

TEST_F(NumberedFilesTest, GapsAreSaidInOneSentence) {
  const auto said = [](std::vector<std::uint64_t> numbers) {
    return gap_sentence({"walk", {}, std::move(numbers)});
  };
  EXPECT_EQ(said({7}), "");
  EXPECT_EQ(said({7, 8, 9}), "");
  EXPECT_EQ(said({1, 2, 4, 8}),
            "files of walk are missing, numbers 3, 5 to 7; vertices move straight across the gaps");
  EXPECT_THAT(said({10, 20, 30}), testing::HasSubstr("in steps of 10"));
  std::vector<std::uint64_t> squares;
  for (std::uint64_t i = 0; i < 100; ++i) squares.push_back(i * i);
  EXPECT_THAT(said(squares), testing::HasSubstr("and 90 more runs"));
}

}  // namespace
}  // namespace mdk::test
