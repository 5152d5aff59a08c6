// Habits of the real viewer on a virtual display: colours, the turntable, and what a session leaves
// behind.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "tests/viewer/mdview_gui.h"
#include "tests/viewer/mdview_title.h"
#include "tests/viewer/x_drop.h"

namespace mdk::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

double brightness(const std::vector<std::uint32_t>& pixels) {
  double sum = 0;
  for (const std::uint32_t p : pixels) sum += (p & 255) + (p >> 8 & 255) + (p >> 16 & 255);
  return sum / (3 * 255 * static_cast<double>(pixels.size()));
}

TEST_F(MdviewGui, IsDarkOrLightByOptionAndByKeyAndThePictureStaysTheSame) {
  const auto window = [&](const std::string& theme) {
    const auto result = start({"bar.mdk", "--size", "900x600", "--theme", theme, "--quit-after",
                               "2", "--screenshot", theme + ".png"})
                            ->finish();
    EXPECT_EQ(result.state["theme"], theme) << result.messages;
    widgets_ = result.state["widgets"];
    return read_png(folder_.file(theme + ".png"));
  };
  const Image dark = window("dark"), light = window("light");
  EXPECT_EQ(cut_out(dark, widgets_["picture"]), cut_out(light, widgets_["picture"]));
  const json& line = widgets_["technique:refit-bvh"];
  EXPECT_LT(brightness(cut_out(dark, line)), 0.25);
  EXPECT_GT(brightness(cut_out(light, line)), 0.8);

  const auto session = start_on_bar();
  session->key("d");
  EXPECT_EQ(session->quit().state["theme"], "light");
}

TEST_F(MdviewGui, TheTurntableGoesRoundAtTheSameDistance) {
  const auto session = start_on_bar({"--camera", "0 0 9 0 0 0 0 1 0 40"});
  session->key("t");
  session->xdotool({"sleep", "1"});
  session->key("t");
  const auto state = session->quit().state;
  EXPECT_EQ(state["turntable"], false);
  EXPECT_GT(state["frames_shown"], 5);
  const Vec3d eye = point_of(state["camera"], 0);
  EXPECT_NEAR(length(eye), 9, 1e-3);
  EXPECT_NEAR(eye.y, 0, 1e-4);
  EXPECT_GT(std::abs(eye.x), 1);
}

TEST_F(MdviewGui, RemembersFromRunToRunWithAStateFile) {
  const std::vector<std::string> words = {"bar.mdk", "--state", "state.json"};
  const auto first = start(words);
  first->wait_for_window();
  for (const char* key : {"d", "3", "s", "Tab"}) first->key(key);
  first->quit();
  const auto state = start({"--state", "state.json", "--quit-after", "1"})->finish().state;
  EXPECT_EQ(state["theme"], "light");
  EXPECT_EQ(state["technique"], "static-kdtree");
  EXPECT_EQ(state["shading"], "normals");
  EXPECT_EQ(state["panel"], false);
  ASSERT_EQ(state["recent_files"].size(), 1u);
  EXPECT_EQ(state["recent_files"][0], folder_.file("bar.mdk"));
  const auto asked =
      start({"--state", "state.json", "--theme", "dark", "--quit-after", "1"})->finish().state;
  EXPECT_EQ(asked["theme"], "dark") << "what is asked for counts";
}

TEST_F(MdviewGui, ScriptedRunsRememberNothing) {
  start({"bar.mdk", "--theme", "light", "--quit-after", "1"})->finish();
  const auto state = start({"--quit-after", "1"})->finish().state;
  EXPECT_EQ(state["theme"], "dark");
  EXPECT_TRUE(state["recent_files"].empty());
}

TEST_F(MdviewGui, ARecentFileIsOpenedFromTheMenuAndAPathCanBeTyped) {
  start({"bar.mdk", "--state", "state.json", "--quit-after", "1"})->finish();
  const std::vector<std::string> words = {"--state", "state.json", "--size", "1280x800"};
  const auto look = start(words);
  look->wait_for_window();
  look->key("l");
  const auto menu = look->close().state;
  widgets_ = menu["widgets"];
  EXPECT_EQ(menu["file_menu"], json::array({"bar.mdk"}));
  const auto session = start(words);
  session->wait_for_window();
  session->key("l");
  session->click(in_widget("choice:0"));
  wait_for_file(*session, "bar.mdk");
  auto state = session->quit().state;
  EXPECT_EQ(state["file"], folder_.file("bar.mdk"));
  EXPECT_TRUE(state["file_menu"].is_null());

  const auto typing = start(words);
  typing->wait_for_window();
  typing->key("l");
  typing->xdotool({"type", "--delay", "60", "bar.mdk"});
  typing->xdotool({"key", "Return"});
  wait_for_file(*typing, "bar.mdk");
  EXPECT_EQ(typing->quit().state["file"], "bar.mdk");

  const auto closing = start(words);
  closing->wait_for_window();
  closing->key("l");
  closing->key("t");  // is typed
  closing->key("Escape");
  state = closing->quit().state;
  EXPECT_TRUE(state["file_menu"].is_null());
  EXPECT_EQ(state["turntable"], false);
}

TEST_F(MdviewGui, ADroppedFolderIsOfferedOrOpenedOrRefused) {
  namespace fs = std::filesystem;
  for (const char* name : {"none", "one", "two"}) fs::create_directory(folder_.file(name));
  fs::copy(folder_.file("bar.mdk"), folder_.file("one/bar.mdk"));
  fs::copy(folder_.file("bar.mdk"), folder_.file("two/a.mdk"));
  fs::copy(folder_.file("bar.mdk"), folder_.file("two/b.mdk"));
  const auto drop = [&](const char* name, const char* opened = nullptr) {
    const auto session = start({"--size", "800x600"});
    session->wait_for_window();
    drop_file(server_->display(), "mdview", folder_.file(name));
    session->xdotool({"sleep", "1"});
    if (opened) wait_for_file(*session, opened);
    return session->close().state;
  };
  EXPECT_EQ(drop("one", "bar.mdk")["file"], folder_.file("one/bar.mdk"));
  EXPECT_EQ(drop("two")["file_menu"], json::array({"a.mdk", "b.mdk"}));
  EXPECT_THAT(drop("none")["error"].get<std::string>(), HasSubstr("holds no animation"));
}

TEST_F(MdviewGui, ExportsTheRangeInTheBackground) {
  const auto session = start_on_bar();
  const double lane = widgets_["range-lane"][2];
  session->drag(in_widget("range-lane", 0.2), {static_cast<int>(0.2 * lane), 0});
  session->key("e");
  for (int i = 0; i < 100 && !std::filesystem::exists(folder_.file("bar-frames-0001/bar_0004.png"));
       ++i)
    session->xdotool({"sleep", "0.1"});
  session->xdotool({"sleep", "0.5"});
  session->key("p");
  const auto state = session->quit().state;
  EXPECT_TRUE(state["exporting"].is_null());
  EXPECT_TRUE(state["error"].is_null()) << state["error"];
  EXPECT_TRUE(std::filesystem::exists(folder_.file("bar-frames-0001/bar_0002.png")));
  EXPECT_FALSE(std::filesystem::exists(folder_.file("bar-frames-0001/bar_0005.png")));
  // The first key is the picture shown at its time.
  const auto shown = start({"bar.mdk", "--size", "1280x800", "--time", "0.2", "--quit-after", "1",
                            "--screenshot", "window.png"})
                         ->finish();
  const Image frame = read_png(folder_.file("bar-frames-0001/bar_0002.png"));
  EXPECT_EQ(frame.pixels,
            cut_out(read_png(folder_.file("window.png")), shown.state["widgets"]["picture"]));
}

TEST_F(MdviewGui, TakesNextToNoProcessorTimeAtRest) {
  const auto session = start_on_bar();
  session->xdotool({"sleep", "5"});  // until the cost curve is whole
  const double before = session->cpu_seconds();
  session->xdotool({"sleep", "5"});
  EXPECT_LT(session->cpu_seconds() - before, 0.25);
  EXPECT_GT(before, 0);
  session->quit();
}

TEST_F(MdviewGui, ThePanelKeepsItsRateWhilePicturesAreSlow) {
  const auto session = start_on_bar({"--samples", "128", "--threads", "1"});
  session->key("space");
  session->xdotool({"sleep", "3"});
  const auto state = session->quit().state;
  EXPECT_GT(state["window_draws"], 3 * state["frames_shown"].get<int>());
}

TEST_F(MdviewGui, GrowsOnADenseDisplay) {
  const auto plain = start({"bar.mdk", "--size", "1280x800", "--quit-after", "1"})->finish().state;
  set_display_density(server_->display(), 192);
  const auto dense = start({"bar.mdk", "--size", "1280x800", "--quit-after", "1"})->finish().state;
  EXPECT_NEAR(dense["widgets"]["play"][2].get<double>(),
              2 * plain["widgets"]["play"][2].get<double>(), 2);
  EXPECT_EQ(dense["window"], plain["window"]);
}

TEST_F(MdviewGui, WithoutOpenGL33ItNamesTheWayOut) {
  ::setenv("MESA_GL_VERSION_OVERRIDE", "2.1", 1);
  const auto result = start({"bar.mdk", "--quit-after", "1"})->finish();
  ::unsetenv("MESA_GL_VERSION_OVERRIDE");
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.messages, HasSubstr("OpenGL 3.3"));
  EXPECT_THAT(result.messages, HasSubstr("mdprep render"));
}

TEST_F(MdviewGui, EveryPageStandsInTheSmallestWindow) {
  for (const char* tab : {"view", "cost", "compare", "clusters", "pick", "file"})
    for (const char* size : {"64x64", "64x800", "1280x64"}) {
      const auto result =
          start({"bar.mdk", "--tab", tab, "--size", size, "--quit-after", "2"})->finish();
      EXPECT_EQ(result.status, 0) << tab << " " << size << ": " << result.messages;
    }
}

}  // namespace
}  // namespace mdk::test
