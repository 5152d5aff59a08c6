#include "tests/viewer/mdview_gui.h"

#include <png.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "formats/mdk/writer.h"
#include "tests/viewer/waving_bar.h"

namespace mdk::test {

using nlohmann::json;

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

void MdviewGui::SetUp() {
  for (const char* program : {"Xvfb", "xdotool"})
    if (!has_program(program)) GTEST_SKIP() << program << " is not installed";
  server_ = std::make_unique<XServer>();
  write_mdk(waving_bar().view(), folder_.file("bar.mdk"));
}

std::unique_ptr<MdviewSession> MdviewGui::start(const std::vector<std::string>& words) {
  return std::make_unique<MdviewSession>(*server_, folder_.path(), words);
}

std::unique_ptr<MdviewSession> MdviewGui::start_on_bar(std::vector<std::string> words) {
  words.insert(words.begin(), {"bar.mdk", "--size", "1280x800"});
  learn_widgets(words);
  auto session = start(words);
  session->wait_for_window();
  return session;
}

void MdviewGui::learn_widgets(std::vector<std::string> words) {
  words.insert(words.end(), {"--quit-after", "2"});
  widgets_.update(start(words)->finish().state["widgets"]);
}

void MdviewGui::look_at_tab(const std::string& tab) {
  learn_widgets({"bar.mdk", "--size", "1280x800", "--tab", tab});
}

Point MdviewGui::in_widget(const std::string& name, double across, double down) {
  const json& r = widgets_[name];
  if (!r.is_array()) {
    ADD_FAILURE() << "the window has no widget " << name;
    return {};
  }
  return {static_cast<int>(r[0].get<double>() + across * r[2].get<double>()),
          static_cast<int>(r[1].get<double>() + down * r[3].get<double>())};
}

void MdviewGui::write_text(const std::string& name, const std::string& text) {
  std::ofstream(folder_.file(name)) << text;
}

}  // namespace mdk::test
