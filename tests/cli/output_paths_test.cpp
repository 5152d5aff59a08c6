#include "preprocess/cli/output_paths.h"

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

}  // namespace
}  // namespace mdk
