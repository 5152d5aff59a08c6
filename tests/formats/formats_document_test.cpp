// docs/formats.md promises sentences and names the tests that hold them: both must exist.
#include <gmock/gmock.h>

#include <filesystem>
#include <regex>

#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

namespace fs = std::filesystem;

/// All .cpp and .h files below the folders, in one text, with broken string literals joined.
std::string sources(const std::vector<std::string>& folders) {
  std::string all;
  for (const std::string& folder : folders)
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(MDK_SOURCE_DIR) / folder))
      if (entry.path().extension() == ".cpp" || entry.path().extension() == ".h")
        all += read_text(entry.path().string());
  return std::regex_replace(all, std::regex("\"\\s*\n\\s*\""), "");
}

std::vector<std::string> found(const std::string& text, const std::string& pattern) {
  std::vector<std::string> all;
  const std::regex regex(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), regex), end; it != end; ++it)
    all.push_back((*it)[1]);
  return all;
}

class FormatsDocument : public testing::Test {
 protected:
  const std::string text_ = read_text(MDK_SOURCE_DIR "/docs/formats.md");
};

TEST_F(FormatsDocument, EveryTestItNamesIsThere) {
  const std::string tests = sources({"tests"});
  const std::vector<std::string> names = found(text_, "`([A-Z]\\w+\\.[A-Z]\\w+)`");
  EXPECT_GT(names.size(), 60u);
  for (const std::string& name : names) {
    const std::size_t dot = name.find('.');
    std::string cased = "(";
    cased.append(name, 0, dot).append(", ").append(name, dot + 1).append(")");
    EXPECT_NE(tests.find(cased), std::string::npos) << name;
  }
}

TEST_F(FormatsDocument, EveryRowNamesATest) {
  for (const std::string& row : found(text_, "(\\| [^\n]* \\|)\n")) {
    if (row.starts_with("| feature ")) continue;
    EXPECT_FALSE(found(row, "`([A-Z]\\w+\\.[A-Z]\\w+)` *").empty()) << row;
  }
}

TEST_F(FormatsDocument, EverySentenceItQuotesIsSaid) {
  const std::string code = sources({"formats", "preprocess"});
  const std::vector<std::string> sentences =
      found(text_, "(?:refused|note|overwritten): \"([^\"]+)\"");
  EXPECT_GE(sentences.size(), 30u);
  for (const std::string& sentence : sentences)
    for (const std::string& part : found(sentence + "…", "(.+?) ?…"))
      EXPECT_NE(code.find(part), std::string::npos) << part << "\nof: " << sentence;
}

}  // namespace
}  // namespace mdk::test
