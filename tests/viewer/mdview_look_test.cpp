// The real viewer on a virtual display: comparing techniques, picking, clusters, boxes over the
// picture.
#include <gmock/gmock.h>

#include <algorithm>
#include <utility>

#include "common/trace/renderer.h"
#include "formats/mdk/mdk_file.h"
#include "tests/viewer/mdview_gui.h"
#include "viewer/state/clusters.h"

namespace mdk::test {
namespace {

using nlohmann::json;

/// The part of a widget below what is written over the picture's upper edge.
json lower_part(const json& rect) {
  const double skip = 60;
  return {rect[0], rect[1].get<double>() + skip, rect[2], rect[3].get<double>() - skip};
}

bool is_grey(std::uint32_t p) {
  return (p & 255) == (p >> 8 & 255) && (p & 255) == (p >> 16 & 255);
}

TEST_F(MdviewGui, ASecondTechniqueIsHeldAgainstTheFirst) {
  look_at_tab("compare");
  const auto session = start_on_bar({"--compare", "wipe", "--tab", "compare", "--time", "0.37",
                                     "--technique", "fuzzy-kdtree", "--screenshot", "window.png"});
  session->click(in_widget("against:refit-bvh"));
  session->drag(in_widget("divider", 0.5, 0.3), {-200, 0});
  const json dragged = session->quit().state;
  EXPECT_EQ(dragged["compare"]["mode"], "wipe");
  EXPECT_EQ(dragged["compare"]["technique"], "refit-bvh");
  EXPECT_EQ(dragged["compare"]["differing_pixels"], 0);
  EXPECT_GT(dragged["compare"]["time_to_image_ms"], 0);
  const double width = dragged["widgets"]["picture"][2];
  EXPECT_NEAR(dragged["compare"]["divider"], 0.5 - 200 / width, 0.01);
  EXPECT_TRUE(dragged["picked"].is_null());  // a drag of the divider is no click
  EXPECT_EQ(dragged["camera"], start_on_bar({"--time", "0.37"})->quit().state["camera"]);
}

TEST_F(MdviewGui, TheDifferenceOfOurTechniquesIsEmpty) {
  look_at_tab("compare");
  const auto session = start_on_bar({"--time", "0.37", "--screenshot", "window.png"});
  session->click(in_widget("tab:compare"));
  session->click(in_widget("compare:difference"));
  session->click(in_widget("against:static-kdtree"));
  const json state = session->quit().state;
  EXPECT_EQ(state["compare"]["mode"], "difference");
  EXPECT_EQ(state["compare"]["technique"], "static-kdtree");
  EXPECT_EQ(state["compare"]["differing_pixels"], 0);
  const auto picture =
      cut_out(read_png(folder_.file("window.png")), lower_part(state["widgets"]["picture"]));
  EXPECT_GT(count_colors(picture), 10u);  // a faint trace of the model
  EXPECT_TRUE(std::all_of(picture.begin(), picture.end(), is_grey));
}

TEST_F(MdviewGui, SideBySideShowsTheSamePictureTwice) {
  const json state = start({"bar.mdk", "--size", "1000x600", "--compare", "side", "--against",
                            "rebuild-bvh", "--quit-after", "2", "--screenshot", "window.png"})
                         ->finish()
                         .state;
  const json place = lower_part(state["widgets"]["picture"]);
  EXPECT_EQ(state["last_frame"]["width"], place[2].get<int>() / 2);
  const Image window = read_png(folder_.file("window.png"));
  // Short of the line between the two.
  const json left = {0, place[1], place[2].get<int>() / 2 - 4, place[3]};
  const json right = {place[2].get<int>() / 2, place[1], place[2].get<int>() / 2 - 4, place[3]};
  const auto first = cut_out(window, left), second = cut_out(window, right);
  EXPECT_GT(count_colors(first), 50u);
  std::size_t different = 0;
  for (std::size_t i = 0; i < first.size(); ++i) different += first[i] != second[i];
  EXPECT_LT(different, 4 * first.size() / left[2].get<std::size_t>());  // the line's own columns
}

TEST_F(MdviewGui, AClickPicksTheTriangleThatIsShownAndADragDoesNot) {
  const auto session = start_on_bar({"--time", "0.37", "--camera", "0 0 9 0 0 0 0 1 0 40"});
  const Point at = in_widget("picture", 0.5, 0.55);
  session->click(at);
  const json state = session->quit().state;
  EXPECT_EQ(state["tab"], "pick");
  ASSERT_FALSE(state["picked"].is_null());

  const MdkFile file(folder_.file("bar.mdk"));
  FrameRequest request;
  request.width = state["last_frame"]["width"];
  request.height = state["last_frame"]["height"];
  request.camera = {{0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 40};
  request.at = locate_time(file.model(), 0, 0.37);
  Renderer renderer(file.model(), "fuzzy-bvh");
  renderer.trace(request);
  EXPECT_EQ(
      state["picked"]["triangle"],
      renderer.hits().triangle(static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y)));

  const auto again = start_on_bar({"--camera", "0 0 9 0 0 0 0 1 0 40"});
  again->click(at);
  again->drag(at, {60, 0});
  EXPECT_FALSE(again->quit().state["picked"].is_null());
  const auto background = start_on_bar({"--camera", "0 0 9 0 0 0 0 1 0 40"});
  background->drag(at, {60, 0});
  background->click(at);
  background->click(in_widget("picture", 0.02, 0.5));
  EXPECT_TRUE(background->quit().state["picked"].is_null());
}

TEST_F(MdviewGui, ClustersAreShownAloneHiddenAndAllAgain) {
  look_at_tab("clusters");
  const auto session = start_on_bar({"--tab", "clusters"});
  session->click(in_widget("cluster:0:solo"));
  session->click(in_widget("world-boxes"));
  json state = session->quit().state;
  EXPECT_EQ(state["clusters"]["solo"], 0);
  EXPECT_EQ(state["clusters"]["shown"], 1);
  EXPECT_EQ(state["overlays"]["world_boxes"], true);
  const int alone = state["last_frame"]["hits"];

  const auto second = start_on_bar({"--tab", "clusters"});
  second->click(in_widget("cluster:0:hide"));
  state = second->quit().state;
  const int others = state["last_frame"]["hits"];
  EXPECT_EQ(state["clusters"]["hovered"], 0);
  EXPECT_TRUE(state["render_command"].is_null());  // none makes a picture of a part
  EXPECT_EQ(state["clusters"]["shown"], state["clusters"]["count"].get<int>() - 1);

  const auto third = start_on_bar({"--tab", "clusters"});
  third->click(in_widget("cluster:0:hide"));
  third->key("a");
  state = third->quit().state;
  EXPECT_EQ(state["clusters"]["shown"], state["clusters"]["count"]);
  const int all = state["last_frame"]["hits"];
  EXPECT_GT(alone, 100);
  EXPECT_LT(alone, all);
  EXPECT_GT(others, 100);
  EXPECT_LT(others, all);
  EXPECT_GE(alone + others, all);
}

TEST_F(MdviewGui, TheListOfClustersIsSortedByAClickOnATitle) {
  look_at_tab("clusters");
  const auto rows_from_above = [&](const json& widgets) {
    std::vector<std::pair<double, std::uint32_t>> rows;
    for (std::uint32_t c = 0; widgets.contains("cluster:" + std::to_string(c)); ++c)
      rows.emplace_back(widgets["cluster:" + std::to_string(c)][1].get<double>(), c);
    std::sort(rows.begin(), rows.end());
    std::vector<std::uint32_t> order;
    for (const auto& [y, c] : rows) order.push_back(c);
    return order;
  };
  const auto session = start_on_bar({"--tab", "clusters"});
  session->click(in_widget("sort:cost"));
  const auto order = rows_from_above(session->quit().state["widgets"]);
  const MdkFile file(folder_.file("bar.mdk"));
  const std::vector<ClusterFacts> facts = cluster_facts(file.model());
  ASSERT_EQ(order.size(), facts.size());
  ASSERT_GE(order.size(), 2u);
  for (std::size_t i = 1; i < order.size(); ++i)
    EXPECT_GE(facts[order[i - 1]].cost_share, facts[order[i]].cost_share);
  const auto second = start_on_bar({"--tab", "clusters"});
  second->click(in_widget("sort:cost"));
  second->click(in_widget("sort:cost"));
  const auto turned = rows_from_above(second->quit().state["widgets"]);
  EXPECT_NE(turned, order);
}

TEST_F(MdviewGui, BoxesAreDrawnOverThePictureAndOnlyThere) {
  look_at_tab("clusters");
  const auto shot = [&](const std::string& box) {
    const auto session =
        start_on_bar({"--tab", "clusters", "--time", "0.37", "--screenshot", "window.png"});
    if (!box.empty()) session->click(in_widget(box));
    session->xdotool({"mousemove", "5", "5", "sleep", "0.3"});
    const json state = session->quit().state;
    return cut_out(read_png(folder_.file("window.png")), state["widgets"]["picture"]);
  };
  const auto plain = shot("");
  std::size_t drawn = 0;
  for (const char* box : {"world-boxes", "local-boxes", "tree-cells"}) {
    const auto picture = shot(box);
    ASSERT_EQ(picture.size(), plain.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < plain.size(); ++i) different += picture[i] != plain[i];
    EXPECT_GT(different, 500u) << box;
    EXPECT_LT(different, plain.size() / 5) << box;
    EXPECT_NE(different, drawn) << box;
    drawn = different;
  }
}

}  // namespace
}  // namespace mdk::test
