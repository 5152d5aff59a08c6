// What the pages of the real viewer's panel tell: shadings and their legend, costs, choices of the
// automatic technique, the picked triangle, depths of trees, and sizes of text.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "common/trace/shading.h"
#include "tests/viewer/mdview_gui.h"

namespace mdk::test {
namespace {

using nlohmann::json;

/// What lines over the picture are drawn in, but for their soft edges.
bool is_yellow(std::uint32_t p) {
  return (p & 255) > 225 && (p >> 8 & 255) > 185 && (p >> 16 & 255) < 120;
}
bool is_red(std::uint32_t p) {
  return (p & 255) > 225 && (p >> 8 & 255) < 120 && (p >> 16 & 255) < 120;
}

class MdviewPages : public MdviewGui {
 protected:
  /// The picture of a session's last window.
  std::vector<std::uint32_t> picture_of(const json& state) {
    return cut_out(read_png(folder_.file("window.png")), state["widgets"]["picture"]);
  }
};

TEST_F(MdviewPages, EveryShadingIsAnotherPictureAndMdprepMakesTheSame) {
  std::set<std::vector<std::uint32_t>> pictures;
  for (const ShadingInfo& info : shading_table()) {
    const std::string id(info.id);
    const auto result = start({"bar.mdk", "--size", "720x480", "--time", "0.37", "--shading", id,
                               "--quit-after", "1", "--screenshot", "window.png"})
                            ->finish();
    ASSERT_EQ(result.status, 0) << result.messages;
    const auto picture = picture_of(result.state);
    EXPECT_TRUE(pictures.insert(picture).second) << id;
    const bool heat = id == "boxes" || id == "tests" || id == "residual";
    EXPECT_EQ(result.state["widgets"].contains("heat-legend"), heat) << id;
    if (heat) {
      EXPECT_GT(count_colors(cut_out(read_png(folder_.file("window.png")),
                                     result.state["widgets"]["heat-legend"])),
                20u);
    }
    std::string command = result.state["render_command"];
    command.replace(0, 6, MDK_MDPREP);
    ASSERT_EQ(std::system(("cd '" + folder_.path() + "' && " + command).c_str()), 0) << command;
    EXPECT_EQ(read_png(folder_.file("bar.png")).pixels, picture) << id;
  }
}

TEST_F(MdviewPages, TheCostPageHasTimesAndWorkOfEveryTechniqueTried) {
  look_at_tab("cost");
  const auto tried = [&](const std::string& columns) {
    const auto session = start_on_bar({"--tab", "cost", "--screenshot", "window.png"});
    session->click(in_widget("count-work"));
    session->key("3");
    session->click(in_widget(columns));
    session->xdotool({"sleep", "0.8"});
    return session->quit().state;
  };
  const json times = tried("costs:times");
  EXPECT_EQ(times["cost_columns"], "times");
  const json row = times["widgets"]["cost:static-kdtree"];
  ASSERT_TRUE(row.is_array());
  EXPECT_TRUE(times["widgets"].contains("cost:fuzzy-bvh"));
  const json cells = {row[0].get<double>() + row[2].get<double>(), row[1], 230, row[3]};
  const auto as_times = cut_out(read_png(folder_.file("window.png")), cells);
  EXPECT_GT(count_colors(as_times), 10u);
  const json work = tried("costs:work");
  EXPECT_EQ(work["cost_columns"], "work");
  EXPECT_NE(cut_out(read_png(folder_.file("window.png")), cells), as_times);
  EXPECT_GT(work["last_frame"]["node_visits_per_ray"], 0);
  EXPECT_GT(work["last_frame"]["structure_bytes"], 0);
}

TEST_F(MdviewPages, AutomaticSaysWhatItChose) {
  const json state = start({"bar.mdk", "--size", "1280x800", "--technique", "auto", "--quit-after",
                            "40", "--screenshot", "window.png"})
                         ->finish()
                         .state;
  EXPECT_EQ(state["last_frame"]["technique"], "auto");
  EXPECT_THAT(state["last_frame"]["note"].get<std::string>(), testing::HasSubstr("ms"));
  ASSERT_TRUE(state["widgets"].contains("chosen"));
  EXPECT_GT(count_colors(cut_out(read_png(folder_.file("window.png")), state["widgets"]["chosen"])),
            10u);
}

TEST_F(MdviewPages, APickedTriangleHasItsBoxItsBasisItsCurveAndItsCluster) {
  const auto picking = [&](const std::vector<std::string>& clicks) {
    const auto session = start_on_bar(
        {"--camera", "2 1 9 0 0 0 0 1 0 40", "--time", "0.3", "--screenshot", "window.png"});
    session->click(in_widget("picture", 0.5, 0.6));
    for (const std::string& widget : clicks) session->click(in_widget(widget));
    session->xdotool({"mousemove", "5", "5", "sleep", "0.3"});
    return session->quit().state;
  };
  const json state = picking({});
  ASSERT_TRUE(state["picked"].is_object());
  const auto with_box = picture_of(state);
  EXPECT_GT(std::ranges::count_if(with_box, is_yellow), 60) << "the fuzzy box";
  EXPECT_GT(std::ranges::count_if(with_box, is_red), 20) << "the basis";
  EXPECT_GT(count_colors(
                cut_out(read_png(folder_.file("window.png")), state["widgets"]["residual-plot"])),
            10u);
  for (const auto& [name, place] : state["widgets"].items()) widgets_[name] = place;

  const json bare = picking({"fuzzy-box", "local-basis"});
  EXPECT_EQ(bare["overlays"]["fuzzy_box"], false);
  EXPECT_EQ(bare["overlays"]["local_basis"], false);
  EXPECT_EQ(std::ranges::count_if(picture_of(bare), is_yellow), 0);
  EXPECT_EQ(std::ranges::count_if(picture_of(bare), is_red), 0);

  const json alone = picking({"pick:solo"});
  EXPECT_EQ(alone["clusters"]["solo"], state["picked"]["cluster"]);
  const json without = picking({"pick:hide"});
  EXPECT_EQ(without["clusters"]["shown"], state["clusters"]["count"].get<int>() - 1);
}

TEST_F(MdviewPages, ABoxOfAPickMovesWithItsCluster) {
  const auto session =
      start_on_bar({"--camera", "2 1 9 0 0 0 0 1 0 40", "--screenshot", "window.png"});
  session->click(in_widget("picture", 0.5, 0.4));
  session->key("P");
  for (int i = 0; i < 3; ++i) session->key("Right");
  session->xdotool({"mousemove", "5", "5", "sleep", "0.3"});
  const json state = session->quit().state;
  const json& place = state["widgets"]["picture"];
  const auto before = cut_out(read_png(folder_.file("bar-0001.png")), place);
  const auto after = picture_of(state);
  std::size_t same = 0, boxes = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    boxes += is_yellow(after[i]);
    same += is_yellow(before[i]) && is_yellow(after[i]);
  }
  EXPECT_GT(boxes, 20u);
  EXPECT_LT(same, boxes / 2);
}

TEST_F(MdviewPages, TreeCellsAreThoseOfTheChosenDepth) {
  look_at_tab("clusters");
  const auto at_depth = [&](double across) {
    const auto session = start_on_bar({"--tab", "clusters", "--screenshot", "window.png"});
    session->click(in_widget("tree-cells"));
    session->click(in_widget("tree-depth", across));
    session->xdotool({"mousemove", "5", "5", "sleep", "0.3"});
    return session->quit().state;
  };
  const json shallow = at_depth(0.02);
  EXPECT_EQ(shallow["overlays"]["tree_depth"], 0);
  const auto few = picture_of(shallow);
  const json deep = at_depth(0.98);
  EXPECT_GT(deep["overlays"]["tree_depth"], 5);
  EXPECT_NE(picture_of(deep), few);
}

TEST_F(MdviewPages, ShowAllBringsHiddenClustersBack) {
  look_at_tab("clusters");
  const auto session = start_on_bar({"--tab", "clusters"});
  session->click(in_widget("cluster:0:hide"));
  session->click(in_widget("show-all"));
  const json clusters = session->quit().state["clusters"];
  EXPECT_EQ(clusters["shown"], clusters["count"]);
}

TEST_F(MdviewPages, TextGrowsAndShrinksWhileTheWindowIsOpenAndIsRemembered) {
  const auto sized = [&](const std::vector<std::string>& keys, int percent) {
    const auto session = start_on_bar({"--state", "state.json", "--screenshot", "window.png"});
    for (const std::string& key : keys) session->key(key);
    const json state = session->quit().state;
    EXPECT_EQ(state["text_percent"], percent);
    const Image window = read_png(folder_.file("window.png"));
    EXPECT_GT(count_colors(cut_out(window, state["widgets"]["page"])), 40u) << percent;
    return state["widgets"];
  };
  const json plain = sized({}, 100), large = sized({"plus", "plus", "plus", "plus", "plus"}, 150);
  const json kept = sized({}, 150);
  EXPECT_EQ(kept, large) << "as it is made at the start, so it is made again";
  const auto width = [](const json& widgets, const char* name) {
    return widgets[name][2].get<double>();
  };
  EXPECT_NEAR(width(large, "play"), 1.5 * width(plain, "play"), 2);
  EXPECT_NEAR(width(large, "page"), 1.5 * width(plain, "page"), 8);
  EXPECT_LT(width(large, "picture"), width(plain, "picture"));
  sized({"minus"}, 140);
}

}  // namespace
}  // namespace mdk::test
