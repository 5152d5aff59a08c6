// What the pages of the real viewer's panel tell: shadings and their legend, costs, choices of the
// automatic technique, the picked triangle, depths of trees, and sizes of text.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <set>

#include "common/motion/model.h"
#include "common/trace/renderer.h"
#include "common/trace/shading.h"
#include "formats/mdk/mdk_file.h"
#include "formats/mdk/writer.h"
#include "tests/viewer/mdview_gui.h"
#include "tests/viewer/waving_bar.h"

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
  write_mdk(waving_bar(129).view(), folder_.file("bar.mdk"));  // whose trees have a depth
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

TEST_F(MdviewPages, ARowUnderThePointerMarksItsClusterInTheWindowAlone) {
  look_at_tab("clusters");
  const auto with_pointer_at = [&](Point at) {
    const auto session = start_on_bar({"--tab", "clusters", "--camera", "0 0 9 0 0 0 0 1 0 40",
                                       "--time", "0.37", "--screenshot", "window.png"});
    session->xdotool({"mousemove", std::to_string(at.x), std::to_string(at.y), "sleep", "0.3"});
    session->key("p");
    return session->quit().state;
  };
  const json away = with_pointer_at({5, 5});
  EXPECT_TRUE(away["clusters"]["hovered"].is_null());
  const auto plain = picture_of(away);
  const json state = with_pointer_at(in_widget("cluster:0", 0.3));
  EXPECT_EQ(state["clusters"]["hovered"], 0);
  EXPECT_EQ(state["render_command"], away["render_command"]);
  EXPECT_EQ(read_png(folder_.file("bar-0002.png")).pixels,
            read_png(folder_.file("bar-0001.png")).pixels)
      << "saved while it was marked";

  const MdkFile file(folder_.file("bar.mdk"));
  const Cluster& cluster = file.model().clusters[0];
  FrameRequest request;
  request.width = state["last_frame"]["width"];
  request.height = state["last_frame"]["height"];
  request.camera = {{0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 40};
  request.at = locate_time(file.model(), 0, 0.37);
  Renderer renderer(file.model(), "fuzzy-bvh");
  renderer.trace(request);
  const auto marked = picture_of(state);
  std::size_t inside = 0, tinted = 0, changed_outside = 0;
  for (std::uint32_t y = 0; y < request.height; ++y)
    for (std::uint32_t x = 0; x < request.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * request.width + x;
      const std::uint32_t triangle = renderer.hits().triangle(x, y);
      const bool is_inside = triangle - cluster.first_triangle < cluster.triangle_count;
      inside += is_inside;
      (is_inside ? tinted : changed_outside) += marked[i] != plain[i];
    }
  EXPECT_GT(inside, 500u);
  EXPECT_GT(tinted, inside * 99 / 100);
  EXPECT_LT(changed_outside, plain.size() / 20) << "only the lines of its box";
}

TEST_F(MdviewPages, ASmallWindowHasEveryControlAndAllKeys) {
  const auto session = start({"bar.mdk", "--size", "800x600"});
  session->wait_for_window();
  session->key("question");
  const json widgets = session->quit().state["widgets"];
  const auto inside = [&](const char* name) {
    ASSERT_TRUE(widgets.contains(name)) << name;
    const json& r = widgets[name];
    EXPECT_GE(r[0], 0) << name;
    EXPECT_GE(r[1], 0) << name;
    EXPECT_LE(r[0].get<double>() + r[2].get<double>(), 800) << name;
    EXPECT_LE(r[1].get<double>() + r[3].get<double>(), 600) << name;
  };
  for (const char* name : {"help-overlay", "play", "end", "loop", "speed", "clip", "time-entry"})
    inside(name);
  EXPECT_GT(widgets["clip"][2], 90);
  EXPECT_GT(widgets["time-entry"][2], 60);
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
  const json largest = sized({"plus", "plus", "plus", "plus", "plus", "plus"}, 200);
  EXPECT_GT(largest["page"][3], 400) << "the page keeps half of the panel";
  EXPECT_TRUE(largest.contains("time-entry"));
}

}  // namespace
}  // namespace mdk::test
