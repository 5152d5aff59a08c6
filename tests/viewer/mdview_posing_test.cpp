// A skeleton posed by hand in the real viewer: joints, sliders, and what lies beyond their limits.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>

#include "tests/viewer/mdview_gui.h"

namespace mdk::test {
namespace {

using nlohmann::json;

class MdviewPosing : public MdviewGui {
 protected:
  void SetUp() override {
    MdviewGui::SetUp();
    if (IsSkipped()) return;
    const std::string bake = std::string(MDK_MDPREP) +
                             " bake -q --decompose bones --sampling pose-space --clips count -o " +
                             folder_.file("hand.mdk") + " " + MDK_ASSETS + "/hand.glb";
    ASSERT_EQ(std::system(bake.c_str()), 0);
    learn_widgets(words_);
  }

  std::unique_ptr<MdviewSession> start_on_hand() {
    auto session = start(words_);
    session->wait_for_window();
    session->click(in_widget("pose-by-hand"));
    return session;
  }

  const std::vector<std::string> words_ = {"hand.mdk", "--size", "1280x800", "--screenshot",
                                           "window.png"};
};

TEST_F(MdviewPosing, JointsTurnLiveWithinTheirLimitsAndPastThemTheBoxesAreOthers) {
  const json rest = start_on_hand()->quit().state;
  ASSERT_TRUE(rest["pose_by_hand"].is_object());
  EXPECT_EQ(rest["pose_by_hand"]["turn_radians"], json::parse("[0.0, 0.0, 0.0]"));
  const auto rest_picture =
      cut_out(read_png(folder_.file("window.png")), rest["widgets"]["picture"]);
  widgets_ = rest["widgets"];
  std::string joint;
  int last = -1;  // the one lowest in the list that can be seen
  for (const auto& [name, place] : widgets_.items())
    if (name.starts_with("joint:") && place[3] > 0 && place[1] > last && place[1] < 200) {
      joint = name;
      last = place[1];
    }
  ASSERT_FALSE(joint.empty());

  const auto turning = start_on_hand();
  turning->click(in_widget(joint));
  turning->drag(in_widget("turn:x", 0.5), {20, 0});
  const json turned = turning->quit().state;
  EXPECT_EQ("joint:" + turned["pose_by_hand"]["joint"].get<std::string>(), joint);
  EXPECT_GT(turned["pose_by_hand"]["turn_radians"][0], 0.05);
  EXPECT_TRUE(turned["pose_by_hand"]["past_limit"].is_null());
  EXPECT_EQ(turned["last_frame"]["technique"], "fuzzy-bvh") << "its boxes hold in every such pose";
  EXPECT_TRUE(turned["render_command"].is_null());
  EXPECT_NE(cut_out(read_png(folder_.file("window.png")), turned["widgets"]["picture"]),
            rest_picture);

  const auto beyond = start_on_hand();
  beyond->click(in_widget(joint));
  beyond->click(in_widget("beyond-limits"));
  beyond->drag(in_widget("turn:x", 0.5), {90, 0});
  const json past = beyond->quit().state;
  EXPECT_EQ("joint:" + past["pose_by_hand"]["past_limit"].get<std::string>(), joint);
  EXPECT_EQ(past["last_frame"]["technique"], "refit-bvh");
  EXPECT_GT(past["last_frame"]["hits"], 1000);
  EXPECT_TRUE(past["widgets"].contains("past-limit")) << "it is said";
  EXPECT_GT(past["widgets"]["past-limit"][3], 20);

  const auto back = start_on_hand();
  back->click(in_widget(joint));
  back->drag(in_widget("turn:x", 0.5), {20, 0});
  back->click(in_widget("pose-rest"));
  const json again = back->quit().state;
  EXPECT_EQ(again["pose_by_hand"]["turn_radians"], json::parse("[0.0, 0.0, 0.0]"));
}

}  // namespace
}  // namespace mdk::test
