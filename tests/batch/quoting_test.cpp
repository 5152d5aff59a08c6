#include "preprocess/batch/quoting.h"

#include <gtest/gtest.h>

#include <vector>

#include "common/base/error.h"
#include "tests/batch/batch_folder.h"

namespace mdk::test {
namespace {

TEST(Quoting, AShellGivesEveryWordBackAsItWas) {
  const std::vector<std::string> words = {
      "plain", "",    "two words", "it's", "$HOME `id` $(id)", "a\\b",  "*?[a]", "~",
      "\"q\"", "a#b", "-n",        "!x",   "a;b&c|d",          "{a,b}", "ü=λ"};
  std::string expected;
  for (const std::string& word : words) expected += "<" + word + ">";
  const BatchFolder folder;
  EXPECT_EQ(folder.shell("printf '<%s>' " + shell_line(words)).out, expected);
}

TEST(Quoting, NinjaAndMakeDoubleTheirDollar) {
  EXPECT_EQ(ninja_path("a b:$c"), "a$ b$:$$c");
  EXPECT_EQ(make_path("a b#$c%"), "a\\ b\\#$$c\\%");
  EXPECT_THROW(make_path("a:b"), Error);
}

}  // namespace
}  // namespace mdk::test
