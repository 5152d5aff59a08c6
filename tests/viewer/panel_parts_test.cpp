// The parts of the panel that need no window: layout, letterbox, keys, history, numbers, state.
#include <GLFW/glfw3.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <utility>

#include "viewer/app/state_report.h"
#include "viewer/panel/commands.h"
#include "viewer/panel/widgets.h"
#include "viewer/state/costs.h"
#include "viewer/state/layout.h"
#include "viewer/window/texture_blit.h"

namespace mdk {
namespace {

TEST(Layout, TilesTheWindowWithoutGapOrOverlap) {
  for (const float scale : {1.0f, 2.0f})
    for (const float width : {64.0f, 640.0f, 1280.0f})
      for (const float height : {64.0f, 800.0f}) {
        const Layout l = make_layout(width, height, scale, PanelMode::kShown);
        const auto area = [](const Rect& r) { return r.width * r.height; };
        EXPECT_EQ(area(l.picture) + area(l.time_line) + area(l.side_panel), width * height);
        EXPECT_GE(l.picture.width, width / 2);
        EXPECT_GE(l.picture.height, height / 2);
        EXPECT_EQ(l.picture.width, l.side_panel.x);
        EXPECT_EQ(l.picture.height, l.time_line.y);
      }
}

TEST(Layout, GivesTheWholeWindowToThePictureWithoutPanel) {
  const Layout l = make_layout(640, 480, 1, PanelMode::kHidden);
  EXPECT_EQ(l.picture, (Rect{0, 0, 640, 480}));
}

TEST(Letterbox, KeepsThePicturesShapeAndIsExactWhereSizesAgree) {
  const PixelRect same = letterbox({10, 20, 300, 200}, 300, 200);
  EXPECT_EQ(same.x, 10);
  EXPECT_EQ(same.y, 20);
  EXPECT_EQ(same.width, 300);
  EXPECT_EQ(same.height, 200);
  const PixelRect wide = letterbox({0, 0, 300, 300}, 100, 50);
  EXPECT_EQ(wide.width, 300);
  EXPECT_EQ(wide.height, 150);
  EXPECT_EQ(wide.y, 75);
  EXPECT_EQ(letterbox({0, 0, 300, 300}, 0, 50).width, 0);
}

TEST(Commands, TheHelpListsEveryKeyAndNoKeyMeansTwoThings) {
  std::set<std::pair<int, unsigned>> seen;
  for (const Shortcut& line : shortcuts())
    for (const auto& [event, command] : line.bindings) {
      EXPECT_TRUE(seen.insert({event.key, event.character}).second) << line.keys;
      ASSERT_TRUE(action_for(event)) << line.keys;
      EXPECT_EQ(action_for(event)->command, command) << line.keys;
      if (event.character == 0) continue;
      // A small letter is listed as the key's face shows it, a capital one with Shift.
      const auto sign = static_cast<char>(event.character);
      const bool is_capital = std::isupper(event.character) != 0;
      const std::string name(1, static_cast<char>(std::toupper(event.character)));
      EXPECT_THAT(std::string(" ") + line.keys + " ",
                  testing::HasSubstr(std::string(is_capital ? " Shift + " : " ") + name + " "))
          << sign;
    }
  EXPECT_GT(seen.size(), 20u);
}

TEST(Commands, KeysAndCharactersMeanWhatTheHelpSays) {
  EXPECT_EQ(action_for({GLFW_KEY_SPACE, 0})->command, Command::kPlayPause);
  EXPECT_EQ(action_for({GLFW_KEY_LEFT, 0})->command, Command::kPreviousKey);
  EXPECT_EQ(action_for({GLFW_KEY_DOWN, 0})->command, Command::kNextTechnique);
  EXPECT_EQ(action_for({0, ']'})->command, Command::kNextTechnique);
  EXPECT_EQ(action_for({0, '?'})->command, Command::kToggleHelp);
  EXPECT_EQ(action_for({0, 'q'})->command, Command::kQuit);
  EXPECT_EQ(action_for({GLFW_KEY_ESCAPE, 0})->command, Command::kDismiss);
  const auto third = action_for({GLFW_KEY_3, 0});
  ASSERT_TRUE(third);
  EXPECT_EQ(third->command, Command::kTechniqueByNumber);
  EXPECT_EQ(third->number, 2u);
  EXPECT_FALSE(action_for({GLFW_KEY_F12, '~'}));
  EXPECT_FALSE(action_for({0, 0}));
  EXPECT_FALSE(action_for({GLFW_KEY_0, '0'}));
}

TEST(FrameHistory, KeepsTheLatestFramesOnly) {
  FrameHistory history;
  for (std::size_t i = 0; i < 2 * FrameHistory::kCapacity; ++i)
    history.add({0, static_cast<double>(i)});
  ASSERT_EQ(history.samples().size(), FrameHistory::kCapacity);
  EXPECT_EQ(history.samples().front().time_to_image_ms, FrameHistory::kCapacity);
  EXPECT_EQ(history.longest_ms(), 2 * FrameHistory::kCapacity - 1);
}

TEST(FrameHistory, MedianIsOfATechniquesOwnLatestFrames) {
  FrameHistory history;
  EXPECT_FALSE(history.median_ms(0));
  for (int i = 0; i < 20; ++i) history.add({0, 1000});
  for (std::size_t i = 0; i < FrameHistory::kMedianOver; ++i) {
    history.add({0, 1 + static_cast<double>(i)});
    history.add({1, 77});
  }
  EXPECT_EQ(history.median_ms(0), 8);
  EXPECT_EQ(history.median_ms(1), 77);
  EXPECT_FALSE(history.median_ms(2));
}

TEST(NumberText, MeasuredFiguresHaveThreeDigits) {
  EXPECT_EQ(milliseconds_text(0.042), "0.04 ms");
  EXPECT_EQ(milliseconds_text(12.34), "12.3 ms");
  EXPECT_EQ(milliseconds_text(128.4), "128 ms");
  EXPECT_EQ(rate_text(64.5e6), "64.5 M");
  EXPECT_EQ(rate_text(87), "87");
}

TEST(StateReport, IsOneLineOfJsonThatTellsAbsentFromZero) {
  ViewState state;
  state.error = "a name with \xff in it: \"quoted\"";
  const std::string line = state_json(state, {});
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const auto json = nlohmann::json::parse(line);
  EXPECT_EQ(json["schema"], "mdview-state/1");
  EXPECT_TRUE(json["file"].is_null());
  EXPECT_TRUE(json["last_frame"].is_null());
  EXPECT_EQ(json["camera"].size(), 10u);
  EXPECT_TRUE(json["error"].is_string());

  state.error.clear();
  state.frames.last = FrameReport{};
  state.frames.last->stats.trace_ms = 2;
  state.frames.last->stats.shade_ms = 1;
  state.frames.last_work = WorkReport{0, 4, {8, 0, 2, 6}};
  const auto full = nlohmann::json::parse(state_json(state, {}));
  EXPECT_TRUE(full["error"].is_null());
  EXPECT_EQ(full["last_frame"]["time_to_image_ms"], 3);
  EXPECT_EQ(full["last_frame"]["node_visits_per_ray"], 2);
  EXPECT_EQ(full["last_frame"]["triangle_tests_per_ray"], 0.5);
  EXPECT_EQ(full["last_frame"]["clusters_per_ray"], 1.5);
}

}  // namespace
}  // namespace mdk
