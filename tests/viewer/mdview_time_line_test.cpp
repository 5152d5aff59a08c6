// The time line of the real viewer: ranges, exact times, cost curves, segments, loops and speeds.
#include <gmock/gmock.h>

#include <cstdlib>
#include <utility>

#include "tests/viewer/mdview_gui.h"

namespace mdk::test {
namespace {

using nlohmann::json;

TEST_F(MdviewGui, ARangeIsDraggedAndPlayingLoopsInsideIt) {
  const auto session = start_on_bar();
  const double lane = widgets_["range-lane"][2];
  session->drag(in_widget("range-lane", 0.2), {static_cast<int>(0.3 * lane), 0});
  session->key("space");
  session->xdotool({"sleep", "1"});
  const auto state = session->quit().state;
  ASSERT_TRUE(state["range"].is_array());
  EXPECT_NEAR(state["range"][0], 0.2, 1e-6) << "at a key";
  EXPECT_NEAR(state["range"][1], 0.5, 1e-6);
  EXPECT_EQ(state["playing"], true);
  EXPECT_GE(state["time"], 0.2);
  EXPECT_LE(state["time"], 0.5);
  EXPECT_GT(state["frames_shown"], 10);
}

TEST_F(MdviewGui, ARangeIsSetByKeysMovedAtAnEndAndCleared) {
  const auto session = start_on_bar({"--time", "0.3"});
  session->key("i");
  session->key("End");
  session->key("Left");
  session->key("Left");
  session->key("o");
  const double lane = widgets_["range-lane"][2];
  session->drag(in_widget("range-lane", 0.8), {static_cast<int>(-0.2 * lane), 0});
  const json range = session->quit().state["range"];
  ASSERT_TRUE(range.is_array());
  EXPECT_NEAR(range[0], 0.3, 1e-6);
  EXPECT_NEAR(range[1], 0.6, 1e-6);

  const auto again = start_on_bar({"--time", "0.3"});
  again->key("i");
  again->key("x");
  EXPECT_TRUE(again->quit().state["range"].is_null());
  const auto third = start_on_bar({"--time", "0.3"});
  third->key("i");
  third->drag(in_widget("range-lane"), {0, 0}, 3);
  EXPECT_TRUE(third->quit().state["range"].is_null());
}

TEST_F(MdviewGui, AnExactTimeCanBeTyped) {
  const auto session = start_on_bar();
  session->click(in_widget("time-entry"));
  session->xdotool({"type", "--delay", "60", "0.137"});
  session->xdotool({"key", "Return"});  // however quick
  session->xdotool({"sleep", "0.3"});
  const auto state = session->quit().state;
  EXPECT_EQ(state["time"], 0.137);
  EXPECT_EQ(state["technique"], "fuzzy-bvh") << "digits that are typed choose no technique";
}

TEST_F(MdviewGui, ClipLoopModeAndSpeedAreChosen) {
  for (const auto& [box, line] :
       {std::pair{"loop", "loop:2"}, {"speed", "speed:4 x"}, {"clip", "clip:nod"}}) {
    const auto look = start_on_bar();
    look->click(in_widget(box));
    widgets_ = look->quit().state["widgets"];  // with the list that has opened
    const Point at = in_widget(line);
    const auto session = start_on_bar();
    session->click(in_widget(box));
    session->click(at);
    const auto state = session->quit().state;
    EXPECT_EQ(state["loop"], std::string(box) == "loop" ? "ping-pong" : "loop");
    EXPECT_EQ(state["speed"], std::string(box) == "speed" ? 4.0 : 1.0);
    EXPECT_EQ(state["clip"], std::string(box) == "clip" ? "nod" : "wave");
  }
}

TEST_F(MdviewGui, TheCostCurveFillsWhileNobodyActsAndIsKeptPerTechnique) {
  const auto session = start_on_bar();
  session->xdotool({"sleep", "2"});
  session->key("3");
  session->xdotool({"sleep", "2"});
  session->key("P");
  const auto state = session->quit().state;
  for (const char* technique : {"fuzzy-bvh", "static-kdtree"}) {
    const json& curve = state["cost_curves"][technique];
    ASSERT_TRUE(curve.is_object()) << technique;
    EXPECT_EQ(curve["moments"], 11);
    EXPECT_EQ(curve["known"], 11);
    EXPECT_GT(curve["longest_ms"], 0);
  }
  EXPECT_EQ(state["cost_curves"].size(), 2u);
  EXPECT_LE(state["frames_shown"], 4) << "what is measured is not shown";
  const Image window = read_png(folder_.file("bar-0001.png"));
  EXPECT_GT(count_colors(cut_out(window, state["widgets"]["time-line"])), 20u);
}

TEST_F(MdviewGui, NothingIsMeasuredWhileTheUserActs) {
  const auto session = start_on_bar({"--play"});
  session->xdotool({"sleep", "2"});
  session->drag(in_widget("picture"), {90, 20});
  EXPECT_EQ(session->quit().state["cost_curves"], json::object());
}

TEST_F(MdviewGui, KeysStandAsTicksAtTheirTimes) {
  const auto state =
      start({"bar.mdk", "--size", "1280x800", "--quit-after", "1", "--screenshot", "window.png"})
          ->finish()
          .state;
  const Image window = read_png(folder_.file("window.png"));
  const json& lane = state["widgets"]["range-lane"];  // as wide as the clip is long
  const double y = lane[1].get<double>() + 2.1 * lane[3].get<double>();
  const auto colors_near = [&](double key) {
    const double x = lane[0].get<double>() + key / 10 * lane[2].get<double>();
    return count_colors(cut_out(window, json{x - 2, y, 5, 1}));
  };
  for (int key = 1; key < 10; ++key) {
    EXPECT_GT(colors_near(key), 1u) << "key " << key;
    EXPECT_EQ(colors_near(key + 0.5), 1u) << "between keys " << key << " and " << key + 1;
  }
}

TEST_F(MdviewGui, SegmentsOfTheFileAreMarked) {
  ASSERT_EQ(std::system((std::string(MDK_MDPREP) + " bake -q --segments 3 -o " +
                         folder_.file("ball.mdk") + " " + MDK_ASSETS + "/ball.glb")
                            .c_str()),
            0);
  const auto state = start({"ball.mdk", "--size", "1280x800", "--quit-after", "2"})->finish().state;
  const json& widgets = state["widgets"];
  ASSERT_TRUE(widgets.contains("segment:1"));
  EXPECT_GT(widgets["segment:1"][0], widgets["segment:0"][0]);
}

}  // namespace
}  // namespace mdk::test
