// MdviewGui: the fixture of tests that look at the real viewer on a virtual display.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/math/vec3.h"
#include "tests/formats/temp_folder.h"
#include "tests/viewer/mdview_session.h"

namespace mdk::test {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;
};

Image read_png(const std::string& path);

/// The pixels under a widget of the state.
std::vector<std::uint32_t> cut_out(const Image& image, const nlohmann::json& rect);

std::size_t count_colors(const std::vector<std::uint32_t>& pixels);

/// Three numbers of the state's camera: 0 its eye, 3 its target.
Vec3d point_of(const nlohmann::json& camera, int first);

/// Has a display of its own and "bar.mdk" in a folder of its own; skips where Xvfb or xdotool is
/// missing.
class MdviewGui : public testing::Test {
 protected:
  void SetUp() override;

  std::unique_ptr<MdviewSession> start(const std::vector<std::string>& words);

  /// A session on the bar that is ready for clicks; learns first where the widgets are.
  std::unique_ptr<MdviewSession> start_on_bar(std::vector<std::string> words = {});

  /// Where widgets are in a window started like this; what is known of others stays. Call it before
  /// a session starts.
  void learn_widgets(std::vector<std::string> words);

  /// Where the widgets of another page of the panel are. Call it before a session starts.
  void look_at_tab(const std::string& tab);

  /// A point inside a widget: parts of its width and height.
  Point in_widget(const std::string& name, double across = 0.5, double down = 0.5);

  void write_text(const std::string& name, const std::string& text);

  TempFolder folder_;
  std::unique_ptr<XServer> server_;
  nlohmann::json widgets_ = nlohmann::json::object();
};

}  // namespace mdk::test
