// The real viewer on a virtual display: pictures, clicks, keys, drags, and files that are no good.
#include "tests/viewer/mdview_gui.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "common/trace/technique.h"
#include "formats/mdk/writer.h"
#include "tests/formats/temp_folder.h"
#include "tests/viewer/waving_bar.h"
#include "tests/viewer/x_drop.h"
#include "viewer/state/settings.h"

namespace mdk::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

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
  EXPECT_GT(state["first_picture_ms"], 0);
  EXPECT_GT(state["open_ms"], 0);
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
  look_at_tab("cost");
  const auto session = start_on_bar();
  session->click(in_widget("technique:rebuild-bvh"));
  session->click(in_widget("shading:clusters"));
  session->click(in_widget("resolution:half"));
  session->click(in_widget("time-line", 0.5));
  session->click(in_widget("tab:cost"));
  session->click(in_widget("count-work"));
  const auto result = session->quit();
  EXPECT_EQ(result.status, 0);
  const json& state = result.state;
  EXPECT_EQ(state["technique"], "rebuild-bvh");
  EXPECT_EQ(state["shading"], "clusters");
  EXPECT_EQ(state["resolution"], "1/2");
  EXPECT_EQ(state["tab"], "cost");
  EXPECT_NEAR(state["time"], 0.5, 0.01);
  const json& frame = state["last_frame"];
  EXPECT_EQ(frame["technique"], "rebuild-bvh");
  const json& picture = state["widgets"]["picture"];
  EXPECT_EQ(frame["width"], picture[2].get<int>() / 2);
  EXPECT_EQ(frame["height"], picture[3].get<int>() / 2);
  EXPECT_GT(frame["node_visits_per_ray"], 0);
  EXPECT_GT(frame["triangle_tests_per_ray"], 0);
}

TEST_F(MdviewGui, EveryPageOfThePanelFitsAWindowOf1280x800) {
  for (const PanelTabInfo& info : panel_tab_table()) {
    const std::string tab(info.id);
    const auto state = start({"bar.mdk", "--size", "1280x800", "--technique", "auto", "--shading",
                              "boxes", "--tab", tab, "--quit-after", "2"})
                           ->finish()
                           .state;
    EXPECT_EQ(state["tab"], tab);
    const double room = state["widgets"]["page"][3], height = state["widgets"]["page-content"][3];
    EXPECT_GT(height, 40) << tab;
    EXPECT_LE(height, room) << tab;
    const json& footer = state["widgets"]["history"];
    EXPECT_LE(footer[1].get<double>() + footer[3].get<double>(), 800) << tab;
  }
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

TEST_F(MdviewGui, FitsTheModelInTheSameDirectionAndGoesBackToTheFirstView) {
  const json first = start_on_bar()->quit().state["camera"];
  const auto session = start_on_bar({"--camera", "0 30 40 0 0 0 0 1 0 40"});
  session->key("f");
  const auto fitted = session->quit().state;
  const Vec3d sight = point_of(fitted["camera"], 3) - point_of(fitted["camera"], 0);
  EXPECT_LT(length(sight), 15);
  EXPECT_NEAR(sight.y / sight.z, 0.75, 1e-3);
  EXPECT_NE(fitted["camera"], first);
  const auto back = start_on_bar({"--camera", "0 30 40 0 0 0 0 1 0 40"});
  back->drag(in_widget("picture"), {90, 20});
  back->key("r");
  EXPECT_EQ(back->quit().state["camera"], first);
}

TEST_F(MdviewGui, WhileDraggingAPictureThatWouldBeLateIsCoarserAndThenSharpens) {
  const auto session = start_on_bar({"--samples", "64", "--threads", "1"});
  const Point from = in_widget("picture");
  session->xdotool({"mousemove", std::to_string(from.x), std::to_string(from.y)});
  session->xdotool({"sleep", "3", "mousedown", "1", "sleep", "0.3"});
  session->xdotool({"mousemove", std::to_string(from.x + 40), std::to_string(from.y)});
  session->xdotool({"sleep", "1.5"});
  session->key("p");
  session->xdotool({"mouseup", "1", "sleep", "3"});
  session->key("p");
  const auto state = session->quit().state;
  const int full = state["widgets"]["picture"][2];
  EXPECT_LE(read_png(folder_.file("bar-0001.png")).width, full / 2);
  EXPECT_EQ(read_png(folder_.file("bar-0002.png")).width, full);
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
