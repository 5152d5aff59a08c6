#include "preprocess/tool/files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>

#include "common/base/error.h"
#include "tests/formats/temp_folder.h"

namespace mdk {
namespace {

using test::TempFolder;

ErrorCode code_of_distinct(const std::string& input, const std::vector<std::string>& outputs) {
  try {
    require_distinct_files(input, outputs);
  } catch (const Error& error) {
    return error.code();
  }
  return ErrorCode::kInternal;
}

TEST(OutputPaths, TakesANewFileInAFolderThatIsThere) {
  const TempFolder folder;
  EXPECT_NO_THROW(require_writable_place(folder.file("new.mdk")));
  EXPECT_TRUE(folder.names().empty()) << "asking must not make anything";
}

TEST(OutputPaths, RefusesAMissingFolderAFolderAndNoName) {
  const TempFolder folder;
  EXPECT_THROW(require_writable_place(folder.file("missing/new.mdk")), Error);
  EXPECT_THROW(require_writable_place(folder.path()), Error);
  EXPECT_THROW(require_writable_place(""), Error);
}

TEST(OutputPaths, RefusesWhatIsNoRegularFile) {
  const TempFolder folder;
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0600), 0);
  EXPECT_THROW(require_writable_place(folder.file("pipe")), Error);
  EXPECT_THROW(require_writable_place("/dev/full"), Error);
  std::filesystem::create_symlink("nothing", folder.file("dangling"));
  EXPECT_NO_THROW(require_writable_place(folder.file("dangling"))) << "it is replaced by the file";
}

TEST(OutputPaths, SeesThroughOtherNamesOfOneFile) {
  const TempFolder folder;
  const std::string input = folder.file("a.glb");
  test::write_text(input, "x");
  std::filesystem::create_symlink(input, folder.file("link.glb"));
  EXPECT_EQ(code_of_distinct(input, {input}), ErrorCode::kUsage);
  EXPECT_EQ(code_of_distinct(input, {folder.path() + "/./a.glb"}), ErrorCode::kUsage);
  EXPECT_EQ(code_of_distinct(input, {folder.file("link.glb")}), ErrorCode::kUsage);
  EXPECT_EQ(code_of_distinct(input, {folder.file("new"), "", folder.path() + "/./new"}),
            ErrorCode::kUsage);
  EXPECT_NO_THROW(
      require_distinct_files(input, std::vector<std::string>{folder.file("b"), "", ""}));
}

std::string one(const std::string& name) {
  const std::string dependencies[] = {name};
  return depfile_text("t", dependencies);
}

TEST(Depfile, IsOneRule) {
  const std::string dependencies[] = {"a.gltf", "sub/a.bin"};
  EXPECT_EQ(depfile_text("out.mdk", dependencies), "out.mdk: \\\n  a.gltf \\\n  sub/a.bin\n");
}

TEST(Depfile, EscapesBlanksHashesAndDollars) {
  EXPECT_EQ(one("a b"), "t: \\\n  a\\ b\n");
  EXPECT_EQ(one("a#b"), "t: \\\n  a\\#b\n");
  EXPECT_EQ(one("a$b"), "t: \\\n  a$$b\n");
  EXPECT_EQ(depfile_text("my out.mdk", {}), "my\\ out.mdk:\n");
}

TEST(Depfile, BackslashesDoubleOnlyBeforeAnEscape) {
  EXPECT_EQ(one("a\\b"), "t: \\\n  a\\b\n");
  EXPECT_EQ(one("a\\ b"), "t: \\\n  a\\\\\\ b\n");
}

TEST(Depfile, RefusesALineBreak) { EXPECT_THROW(one("a\nb"), Error); }

TEST(NumberedPath, FillsTheLastRunOfTheFileName) {
  EXPECT_EQ(numbered_path("out_####.png", 7), "out_0007.png");
  EXPECT_EQ(numbered_path("#.png", 123), "123.png");
  EXPECT_EQ(numbered_path("a#b/c_##.png", 5), "a#b/c_05.png");
  EXPECT_EQ(numbered_path("a##_b#.png", 5), "a##_b5.png");
  EXPECT_EQ(numbered_path("a##/plain.png", 5), "a##/plain.png");
}

TEST(NumberedPath, OnlyTheFileNameCanHoldANumber) {
  EXPECT_TRUE(has_number_place("a/b_#.png"));
  EXPECT_FALSE(has_number_place("a#/b.png"));
  EXPECT_FALSE(has_number_place("b.png"));
}

}  // namespace
}  // namespace mdk
