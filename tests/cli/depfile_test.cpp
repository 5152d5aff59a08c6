#include "preprocess/cli/depfile.h"

#include <gtest/gtest.h>

#include "common/base/error.h"

namespace mdk {
namespace {

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

}  // namespace
}  // namespace mdk
