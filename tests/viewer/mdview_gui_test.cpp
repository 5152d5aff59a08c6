// The real viewer on a virtual display: pictures, clicks, keys, drags, and files that are no good.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>

#include "common/trace/technique.h"
#include "formats/mdk_writer.h"
#include "tests/formats/temp_folder.h"
#include "tests/viewer/mdview_session.h"
#include "tests/viewer/waving_bar.h"
#include "tests/viewer/x_drop.h"

namespace mdk::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;
};

Image read_png(const std::string& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  Image image;
  if (!png_image_begin_read_from_file(&png, path.c_str())) {
    ADD_FAILURE() << path << ": " << png.message;
    return image;
  }
  png.format = PNG_FORMAT_RGBA;
  image.width = static_cast<int>(png.width);
  image.height = static_cast<int>(png.height);
  image.pixels.resize(static_cast<std::size_t>(png.width) * png.height);
  EXPECT_TRUE(png_image_finish_read(&png, nullptr, image.pixels.data(), 0, nullptr));
  return image;
}

// The pixels under a widget of the state.
std::vector<std::uint32_t> cut_out(const Image& image, const json& rect) {
  const int x0 = rect[0], y0 = rect[1], width = rect[2], height = rect[3];
  std::vector<std::uint32_t> pixels;
  for (int y = std::max(0, y0); y < std::min(image.height, y0 + height); ++y)
    for (int x = std::max(0, x0); x < std::min(image.width, x0 + width); ++x)
      pixels.push_back(image.pixels[static_cast<std::size_t>(y) * image.width + x]);
  return pixels;
}

std::size_t count_colors(const std::vector<std::uint32_t>& pixels) {
  return std::set<std::uint32_t>(pixels.begin(), pixels.end()).size();
}

Vec3d point_of(const json& camera, int first) {
  return {camera[first], camera[first + 1], camera[first + 2]};
}

class MdviewGui : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* program : {"Xvfb", "xdotool"})
      if (!has_program(program)) GTEST_SKIP() << program << " is not installed";
    server_ = std::make_unique<XServer>();
    write_mdk(waving_bar().view(), folder_.file("bar.mdk"));
  }

  std::unique_ptr<MdviewSession> start(const std::vector<std::string>& words) {
    return std::make_unique<MdviewSession>(*server_, folder_.path(), words);
  }

  // A session on the bar that is ready for clicks; learns first where the widgets are.
  std::unique_ptr<MdviewSession> start_on_bar(std::vector<std::string> words = {}) {
    words.insert(words.begin(), {"bar.mdk", "--size", "1280x800"});
    std::vector<std::string> look = words;
    look.insert(look.end(), {"--quit-after", "2"});
    widgets_ = start(look)->finish().state["widgets"];
    auto session = start(words);
    session->wait_for_window();
    return session;
  }

  // A point inside a widget: parts of its width and height.
  Point in_widget(const std::string& name, double across = 0.5, double down = 0.5) {
    const json& r = widgets_[name];
    if (!r.is_array()) {
      ADD_FAILURE() << "the window has no widget " << name;
      return {};
    }
    return {static_cast<int>(r[0].get<double>() + across * r[2].get<double>()),
            static_cast<int>(r[1].get<double>() + down * r[3].get<double>())};
  }

  void write_text(const std::string& name, const std::string& text) {
    std::ofstream(folder_.file(name)) << text;
  }

  TempFolder folder_;
  std::unique_ptr<XServer> server_;
  json widgets_;
};

TEST_F(MdviewGui, AScriptedRunSavesTheWholeWindowAndPrintsItsState) {
  const auto result =
      start({"bar.mdk", "--size", "900x600", "--technique", "refit-bvh", "--shading", "normals",
             "--clip", "nod", "--time", "0.13", "--camera", "1 2 9 0 0 0 0 1 0 40", "--threads",
             "1", "--quit-after", "3", "--screenshot", "window.png"})
          ->finish();
  EXPECT_EQ(result.status, 0) << result.messages;
  EXPECT_EQ(result.messages, "");
  const json& state = result.state;
  EXPECT_EQ(state["schema"], "mdview-state/1");
  EXPECT_EQ(state["technique"], "refit-bvh");
  EXPECT_EQ(state["shading"], "normals");
  EXPECT_EQ(state["clip"], "nod");
  EXPECT_EQ(state["time"], 0.13);
  EXPECT_EQ(state["playing"], false);
  EXPECT_EQ(state["camera"], json::parse("[1,2,9,0,0,0,0,1,0,40]"));
  EXPECT_TRUE(state["error"].is_null());
  EXPECT_GE(state["frames_shown"], 3);
  const json& frame = state["last_frame"];
  EXPECT_EQ(frame["technique"], "refit-bvh");
  EXPECT_EQ(frame["rays"].get<int>(), frame["width"].get<int>() * frame["height"].get<int>());
  EXPECT_GT(frame["hits"], 500);
  EXPECT_GT(frame["time_to_image_ms"], 0);

  const Image window = read_png(folder_.file("window.png"));
  EXPECT_EQ(window.width, 900);
  EXPECT_EQ(window.height, 600);
  EXPECT_GT(count_colors(cut_out(window, state["widgets"]["picture"])), 50u);
  EXPECT_GT(count_colors(cut_out(window, state["widgets"]["technique:refit-bvh"])), 5u);
}

TEST_F(MdviewGui, EveryTechniqueOfOursShowsTheSamePicture) {
  std::vector<std::uint32_t> first;
  for (const TechniqueInfo& technique : technique_table()) {
    if (technique.kind == TechniqueKind::kPeer) continue;
    const std::string id(technique.id);
    const auto result = start({"bar.mdk", "--size", "640x400", "--time", "0.37", "--technique", id,
                               "--quit-after", "1", "--screenshot", "window.png"})
                            ->finish();
    ASSERT_EQ(result.status, 0) << result.messages;
    const auto picture =
        cut_out(read_png(folder_.file("window.png")), result.state["widgets"]["picture"]);
    if (first.empty()) first = picture;
    EXPECT_EQ(picture, first) << id;
  }
}

TEST_F(MdviewGui, ClicksOnThePanelActOnTheNextFrame) {
  const auto session = start_on_bar();
  session->click(in_widget("technique:rebuild-bvh"));
  session->click(in_widget("shading:clusters"));
  session->click(in_widget("resolution:half"));
  session->click(in_widget("count-work"));
  session->click(in_widget("time-line", 0.5));
  const auto result = session->quit();
  EXPECT_EQ(result.status, 0);
  const json& state = result.state;
  EXPECT_EQ(state["technique"], "rebuild-bvh");
  EXPECT_EQ(state["shading"], "clusters");
  EXPECT_EQ(state["resolution"], "1/2");
  EXPECT_NEAR(state["time"], 0.5, 0.01);
  const json& frame = state["last_frame"];
  EXPECT_EQ(frame["technique"], "rebuild-bvh");
  const json& picture = state["widgets"]["picture"];
  EXPECT_EQ(frame["width"], picture[2].get<int>() / 2);
  EXPECT_EQ(frame["height"], picture[3].get<int>() / 2);
  EXPECT_GT(frame["node_visits_per_ray"], 0);
  EXPECT_GT(frame["triangle_tests_per_ray"], 0);
}

TEST_F(MdviewGui, PlayRunsUntilPauseAndTheTimeLineCanBeDragged) {
  const auto session = start_on_bar();
  session->click(in_widget("play"));
  session->click(in_widget("next-key"));  // pauses on a key
  session->drag(in_widget("time-line", 0.2), {400, 0});
  auto result = session->quit();
  const double dragged = result.state["time"];
  const json& line = result.state["widgets"]["time-line"];
  EXPECT_NEAR(dragged, 0.2 + 400 / line[2].get<double>(), 0.02);
  EXPECT_EQ(result.state["playing"], false);
  EXPECT_GT(result.state["frames_shown"], 4);

  const auto playing = start_on_bar();
  playing->click(in_widget("play"));
  result = playing->quit();
  EXPECT_EQ(result.state["playing"], true);
  EXPECT_NE(result.state["time"], 0);
}

TEST_F(MdviewGui, KeysDoWhatTheHelpSays) {
  const auto session = start_on_bar();
  for (const char* key : {"Right", "Right", "Right", "Left", "3", "bracketright", "s", "question"})
    session->key(key);
  auto state = session->quit().state;
  EXPECT_EQ(state["time"], 0.2);
  EXPECT_EQ(state["key"], 2);
  EXPECT_EQ(state["technique"], technique_table()[3].id);
  EXPECT_EQ(state["shading"], "normals");
  EXPECT_EQ(state["help"], true);
  EXPECT_EQ(state["last_frame"]["technique"], technique_table()[3].id);

  const auto again = start_on_bar();
  for (const char* key : {"space", "End", "space", "Home", "Up", "Tab"}) again->key(key);
  state = again->quit().state;
  EXPECT_EQ(state["time"], 0);
  EXPECT_EQ(state["technique"], technique_table().back().id);
  EXPECT_EQ(state["panel"], false);
  EXPECT_EQ(state["last_frame"]["width"], 1280);
  EXPECT_EQ(state["last_frame"]["height"], 800);
}

TEST_F(MdviewGui, EscapeClosesTheHelpAndThenTheProgram) {
  const auto session = start_on_bar();
  session->key("F1");
  session->key("Escape");
  EXPECT_TRUE(session->running());
  session->xdotool({"key", "Escape"});
  const auto result = session->finish();
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.state["help"], false);
}

TEST_F(MdviewGui, TheMouseOrbitsPansAndZoomsOverThePictureOnly) {
  const auto session = start_on_bar({"--camera", "0 0 9 0 0 0 0 1 0 40"});
  session->drag(in_widget("picture"), {120, 40});
  const json orbited = session->quit().state["camera"];
  EXPECT_NEAR(length(point_of(orbited, 0)), 9, 1e-3);
  EXPECT_LT(orbited[0], -1);
  EXPECT_GT(orbited[1], 0.5);
  EXPECT_EQ(point_of(orbited, 3), (Vec3d{0, 0, 0}));

  const auto second = start_on_bar({"--camera", "0 0 9 0 0 0 0 1 0 40"});
  second->drag(in_widget("picture"), {0, 100}, 3);
  second->wheel_up(in_widget("picture"));
  second->drag(in_widget("history"), {100, 100});
  const json moved = second->quit().state["camera"];
  EXPECT_NEAR(moved[3], 0, 1e-6);
  EXPECT_GT(moved[4], 0.3);
  EXPECT_NEAR(length(point_of(moved, 0) - point_of(moved, 3)), 9 * 0.9, 1e-3);
}

TEST_F(MdviewGui, SavesThePictureInFull) {
  const auto session = start_on_bar();
  session->key("p");
  session->key("P");
  const auto state = session->quit().state;
  const Image picture = read_png(folder_.file("bar-0001.png"));
  EXPECT_EQ(picture.width, state["last_frame"]["width"]);
  EXPECT_EQ(picture.height, state["last_frame"]["height"]);
  EXPECT_GT(count_colors(picture.pixels), 50u);
  const Image window = read_png(folder_.file("bar-0002.png"));
  EXPECT_EQ(window.width, 1280);
  EXPECT_EQ(window.height, 800);
}

TEST_F(MdviewGui, RestsWhenNothingChanges) {
  const auto session = start_on_bar();
  session->xdotool({"sleep", "3"});
  const auto state = session->quit().state;
  EXPECT_LE(state["frames_shown"], 2);
  EXPECT_LE(state["window_draws"], 20);
}

TEST_F(MdviewGui, AMissingFileIsSaidInTheWindowWhichLivesOn) {
  const auto session = start({"missing.mdk", "--size", "1280x800", "--screenshot", "window.png"});
  session->wait_for_window();
  session->key("s");
  EXPECT_TRUE(session->running());
  const auto result = session->quit();
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.state["error"].get<std::string>(), HasSubstr("missing.mdk"));
  EXPECT_EQ(result.state["shading"], "normals");
  EXPECT_TRUE(result.state["file"].is_null());
  const Image window = read_png(folder_.file("window.png"));
  EXPECT_GT(count_colors(cut_out(window, result.state["widgets"]["error"])), 10u);
}

TEST_F(MdviewGui, ScriptedRunsOnBadFilesEndWithTheirStatus) {
  auto result = start({"missing.mdk", "--quit-after", "2"})->finish();
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.messages, HasSubstr("missing.mdk"));

  Bytes bytes = read_bytes(folder_.file("bar.mdk"));
  bytes.resize(bytes.size() / 2);
  write_bytes(folder_.file("cut.mdk"), bytes);
  result = start({"cut.mdk", "--quit-after", "2"})->finish();
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.state["error"].get<std::string>(), HasSubstr("cut.mdk"));

  write_text("bad.glb", "no model at all");
  result = start({"bad.glb", "--quit-after", "2"})->finish();
  EXPECT_EQ(result.status, 3);
  EXPECT_THAT(result.state["error"].get<std::string>(), HasSubstr("bad.glb"));

  result = start({"bar.mdk", "--clip", "dance", "--quit-after", "2"})->finish();
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.state["error"].get<std::string>(), HasSubstr("\"wave\" \"nod\""));
}

TEST_F(MdviewGui, AFileDroppedOnTheWindowIsOpenedAndABadOneLeavesTheOldOneOpen) {
  const auto session = start({"--size", "800x600"});
  session->wait_for_window();
  drop_file(server_->display(), "mdview", folder_.file("bar.mdk"));
  session->xdotool({"sleep", "1"});
  write_text("bad.glb", "no model at all");
  drop_file(server_->display(), "mdview", folder_.file("bad.glb"));
  session->xdotool({"sleep", "1"});
  const auto state = session->quit().state;
  EXPECT_EQ(state["file"], folder_.file("bar.mdk"));
  EXPECT_EQ(state["clip"], "wave");
  EXPECT_GT(state["last_frame"]["hits"], 0);
  EXPECT_THAT(state["error"].get<std::string>(), HasSubstr("bad.glb"));
}

TEST_F(MdviewGui, ASourceFileIsBakedFirst) {
  write_text("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  const auto result = start({"square.obj", "--size", "640x400", "--quit-after", "2"})->finish();
  EXPECT_EQ(result.status, 0) << result.messages;
  EXPECT_EQ(result.state["file"], "square.obj");
  EXPECT_TRUE(result.state["baking"].is_null());
  EXPECT_GT(result.state["last_frame"]["hits"], 1000);
}

TEST_F(MdviewGui, AFileThatChangesOnDiskIsLoadedAgainInTheSameView) {
  const auto session = start_on_bar({"--clip", "nod"});
  session->click(in_widget("time-line", 0.5));
  session->drag(in_widget("picture"), {90, 20});
  write_mdk(waving_bar().view(), folder_.file("bar.mdk"));
  session->xdotool({"sleep", "2"});
  const auto state = session->quit().state;
  EXPECT_THAT(state["notice"].get<std::string>(), HasSubstr("again"));
  EXPECT_EQ(state["clip"], "nod");
  EXPECT_NEAR(state["time"], 0.2, 0.01);
  EXPECT_GT(state["last_frame"]["hits"], 100);
}

TEST_F(MdviewGui, TheCopiedCommandRendersTheSamePicture) {
  const auto session = start_on_bar({"--clip", "nod", "--time", "0.13", "--shading", "normals"});
  session->drag(in_widget("picture"), {90, 20});
  session->key("c");
  session->key("p");
  const auto state = session->quit().state;
  std::string command = state["render_command"];
  ASSERT_THAT(command, testing::StartsWith("mdprep render bar.mdk -o bar.png"));
  command.replace(0, 6, MDK_MDPREP);
  ASSERT_EQ(std::system(("cd '" + folder_.path() + "' && " + command).c_str()), 0) << command;
  const Image rendered = read_png(folder_.file("bar.png"));
  EXPECT_EQ(rendered.pixels, read_png(folder_.file("bar-0001.png")).pixels);
  EXPECT_GT(count_colors(rendered.pixels), 50u);
}

TEST_F(MdviewGui, OpensWithoutAFile) {
  const auto result =
      start({"--size", "800x600", "--quit-after", "2", "--screenshot", "window.png"})->finish();
  EXPECT_EQ(result.status, 0);
  EXPECT_TRUE(result.state["file"].is_null());
  EXPECT_TRUE(result.state["last_frame"].is_null());
  const Image window = read_png(folder_.file("window.png"));
  EXPECT_GT(count_colors(cut_out(window, result.state["widgets"]["picture"])), 20u);
}

TEST(MdviewWithoutDisplay, SaysWhatToDoInstead) {
  TempFolder folder;
  const auto result = run_without_display(folder.path(), {"--quit-after", "1"});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.messages, HasSubstr("mdprep render"));
  EXPECT_TRUE(result.state.is_null());
}

TEST(MdviewWithoutDisplay, RefusesWrongUseBeforeItLooksForOne) {
  TempFolder folder;
  const auto result = run_without_display(folder.path(), {"--frobnicate"});
  EXPECT_EQ(result.status, 2);
  EXPECT_THAT(result.messages, HasSubstr("--frobnicate"));
}

}  // namespace
}  // namespace mdk::test
