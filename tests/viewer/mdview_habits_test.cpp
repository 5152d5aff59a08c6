// Habits of the real viewer on a virtual display: colours, the turntable, and what a session leaves
// behind.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/viewer/mdview_gui.h"

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

}  // namespace
}  // namespace mdk::test
