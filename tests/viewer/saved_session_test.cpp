// What is remembered from run to run: kept whole, read back, and never a reason to fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "tests/formats/temp_folder.h"
#include "viewer/app/session.h"

namespace mdk::test {
namespace {

/// Sets a variable of the environment, or unsets it, while it lives.
class Variable {
 public:
  Variable(const char* name, const std::optional<std::string>& value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    set(value);
  }
  ~Variable() { set(old_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const std::optional<std::string>& value) {
    if (value)
      ::setenv(name_, value->c_str(), 1);
    else
      ::unsetenv(name_);
  }
  const char* name_;
  std::optional<std::string> old_;
};

SavedSession some_session() {
  SavedSession session;
  session.window = WindowSize{900, 700};
  session.settings.technique = 4;
  session.settings.shading = ShadingMode::kNormals;
  session.settings.resolution = Resolution::kHalf;
  session.settings.colors = ColorScheme::kLight;
  session.settings.text_percent = 130;
  session.loop = LoopMode::kPingPong;
  session.speed = 0.25;
  session.panel = PanelMode::kHidden;
  remember_file(session.recent, {"/models/cow.obj", "/models/cow.pc2"});
  remember_file(session.recent, {"/models/hand.mdk"});
  return session;
}

TEST(SavedSession, ComesBackAsItWas) {
  TempFolder folder;
  const std::string path = folder.file("not/yet/there/session.json");
  ASSERT_TRUE(write_session(some_session(), path));
  EXPECT_EQ(read_session(path), some_session());
}

TEST(SavedSession, DamagedFilesGiveDefaults) {
  TempFolder folder;
  const std::string path = folder.file("session.json");
  EXPECT_EQ(read_session(path), SavedSession{}) << "missing";
  for (const char* text :
       {"", "{", "[1,2]", "null", "{\"window\":[1,2],\"technique\":\"magic\",\"speed\":\"fast\"}",
        "{\"window\":[1e300,-5],\"loop\":7,\"resolution\":-1,\"recent\":[[],7,[3]],\"light\":3}"}) {
    std::ofstream(path) << text;
    EXPECT_EQ(read_session(path), SavedSession{}) << text;
  }
  EXPECT_EQ(read_session(folder.path()), SavedSession{}) << "a folder";
}

TEST(SavedSession, TextIsNeverTooSmallOrTooLargeToBeSetBack) {
  TempFolder folder;
  const std::string path = folder.file("session.json");
  for (const auto& [said, read] :
       {std::pair{"-1e300", 70}, {"3", 70}, {"110", 110}, {"9999", 200}}) {
    std::ofstream(path) << R"({"text_percent": )" << said << "}";
    EXPECT_EQ(read_session(path).settings.text_percent, read) << said;
  }
  ViewSettings settings;
  settings.step_text_size(-100);
  EXPECT_EQ(settings.text_percent, kMinTextPercent);
  settings.step_text_size(1);
  EXPECT_EQ(settings.text_percent, kMinTextPercent + 10);
}

TEST(SavedSession, AnyCutOfAGoodFileIsReadWithoutFailing) {
  TempFolder folder;
  const std::string path = folder.file("session.json");
  ASSERT_TRUE(write_session(some_session(), path));
  const auto whole = std::filesystem::file_size(path);
  for (std::uintmax_t size = whole - 2; size > 0; size /= 2) {
    std::filesystem::resize_file(path, size);
    EXPECT_EQ(read_session(path), SavedSession{}) << size;
  }
}

TEST(SavedSession, WhereNothingCanBeWrittenIsSaidAndNothingMore) {
  TempFolder folder;
  std::ofstream(folder.file("file")) << "x";
  EXPECT_FALSE(write_session({}, folder.file("file") + "/session.json"));
}

TEST(SessionPath, FollowsTheEnvironmentAndTheOptions) {
  const Variable home("HOME", "/home/ann");
  {
    const Variable state("XDG_STATE_HOME", "/var/ann");
    EXPECT_EQ(session_path({}), "/var/ann/mdview/session.json");
  }
  const Variable state("XDG_STATE_HOME", std::nullopt);
  EXPECT_EQ(session_path({}), "/home/ann/.local/state/mdview/session.json");
  ViewerOptions options;
  options.print_state = true;
  EXPECT_EQ(session_path(options), "");
  options.state_file = "here.json";
  EXPECT_EQ(session_path(options), "here.json");
  ViewerOptions none;
  none.no_state = true;
  EXPECT_EQ(session_path(none), "");
  const Variable homeless("HOME", std::nullopt);
  EXPECT_EQ(session_path({}), "");
}

TEST(RecentFiles, AreNewestFirstEachOnceAndBounded) {
  std::vector<FileChoice> recent;
  for (int i = 0; i < 30; ++i)
    remember_file(recent, {std::string("/m/") + std::to_string(i) + ".mdk"});
  remember_file(recent, {"/m/./25.mdk"});
  ASSERT_EQ(recent.size(), kMaxRecentFiles);
  EXPECT_EQ(recent[0].paths, (std::vector<std::string>{"/m/25.mdk"}));
  EXPECT_EQ(recent[0].label, "25.mdk");
  EXPECT_EQ(recent[1].label, "29.mdk");
  EXPECT_EQ(std::ranges::count(recent, recent[0]), 1);
  remember_file(recent, {});
  EXPECT_EQ(recent.size(), kMaxRecentFiles);
}

}  // namespace
}  // namespace mdk::test
