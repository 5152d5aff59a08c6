#include "preprocess/batch/path_pattern.h"

#include <gmock/gmock.h>

#include "common/base/error.h"
#include "tests/batch/batch_folder.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(PathPattern, MatchesAsAShellDoes) {
  EXPECT_TRUE(matches_pattern("out/*.mdk", "out/a.mdk"));
  EXPECT_FALSE(matches_pattern("out/*.mdk", "out/b/a.mdk"));
  EXPECT_FALSE(matches_pattern("out/*.mdk", "out/.a.mdk"));
  EXPECT_TRUE(matches_pattern("**/*.mdk", "a.mdk"));
  EXPECT_TRUE(matches_pattern("out/**/*.mdk", "out/b/c/a.mdk"));
  EXPECT_FALSE(matches_pattern("out/**/*.mdk", "in/a.mdk"));
  EXPECT_FALSE(matches_pattern("**/*.mdk", ".git/a.mdk"));
  EXPECT_TRUE(matches_pattern("walk_0[1-3]?.glb", "walk_021.glb"));
  EXPECT_FALSE(matches_pattern("walk_0[1-3]?.glb", "walk_041.glb"));
}

TEST(PathPattern, FindsFilesSortedAndNeverFolders) {
  const BatchFolder folder;
  for (const char* name : {"b.glb", "a.glb", "B.glb", "deep/er/c.glb", ".hidden/d.glb", "x.glb/e"})
    folder.write(name, "");
  EXPECT_THAT(files_matching(folder.path(), "*.glb"), ElementsAre("B.glb", "a.glb", "b.glb"));
  EXPECT_THAT(files_matching(folder.path(), "**/*.glb"),
              ElementsAre("B.glb", "a.glb", "b.glb", "deep/er/c.glb"));
  EXPECT_THAT(files_matching(folder.path(), "deep/*/c.glb"), ElementsAre("deep/er/c.glb"));
  EXPECT_THAT(files_matching(folder.path(), "none/*"), IsEmpty());
  EXPECT_THAT(files_matching(folder.path(), "not there.glb"), ElementsAre("not there.glb"));
  EXPECT_THAT(files_matching("/", folder.file("?.glb")).size(), 3u);
}

TEST(PathPattern, FillsNames) {
  EXPECT_EQ(fill_name("out/{folder}/{stem}.mdk", "in/a/b/walk.glb", "in/**/*.glb"),
            "out/a/b/walk.mdk");
  EXPECT_EQ(plain_path(fill_name("out/{folder}/{stem}.mdk", "walk.glb", "*.glb")), "out/walk.mdk");
  EXPECT_EQ(plain_path(fill_name("out/{folder}/{stem}.mdk", "in/walk.glb", "in/walk.glb")),
            "out/walk.mdk");
  EXPECT_EQ(fill_name("{stem}{stem}", "a/two words.tar.gz", "a/*"), "two words.tartwo words.tar");
  EXPECT_THROW(fill_name("{name}", "a", "a"), Error);
  EXPECT_THROW(fill_name("{stem", "a", "a"), Error);
}

}  // namespace
}  // namespace mdk::test
