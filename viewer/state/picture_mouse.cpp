#include "viewer/state/picture_mouse.h"

#include <imgui.h>

#include <algorithm>

namespace mdk {

namespace {

constexpr float kClickReach = 4;  // window coordinates a hand may slip

}  // namespace

bool steer_by_mouse(OrbitCamera& camera, const Rect& picture) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantCaptureMouse || !(picture.height > 0)) return false;
  const auto held = [&](ImGuiMouseButton button) {
    return io.MouseDown[button] && io.MouseDownDuration[button] > 0;
  };
  const PictureOffset drag{static_cast<double>(io.MouseDelta.x / picture.height),
                           static_cast<double>(io.MouseDelta.y / picture.height)};
  const bool pans = held(ImGuiMouseButton_Middle) || held(ImGuiMouseButton_Right) ||
                    (held(ImGuiMouseButton_Left) && io.KeyShift);
  const bool moved = drag.x != 0 || drag.y != 0;
  if (pans && moved)
    camera.pan(drag);
  else if (held(ImGuiMouseButton_Left) && moved)
    camera.orbit(drag);

  if (io.MouseWheel != 0 && picture.contains(io.MousePos.x, io.MousePos.y)) {
    const PictureOffset pointer{
        static_cast<double>((io.MousePos.x - picture.x - picture.width / 2) / picture.height),
        static_cast<double>((io.MousePos.y - picture.y - picture.height / 2) / picture.height)};
    camera.zoom(static_cast<double>(io.MouseWheel), pointer);
  }
  return pans || held(ImGuiMouseButton_Left);
}

bool pick_by_mouse(ViewState& state, const Rect& picture) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool clicked =
      ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !io.WantCaptureMouse && !io.KeyShift &&
      io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left] < kClickReach * kClickReach;
  if (!clicked || !state.last_frame) return false;
  const FrameReport& frame = *state.last_frame;
  for (const Rect& place : picture_places(picture, state.compare.mode)) {
    if (!place.contains(io.MousePos.x, io.MousePos.y)) continue;
    const auto pixel = [](float part, std::uint32_t count) {
      return std::min(count - 1, static_cast<std::uint32_t>(part * static_cast<float>(count)));
    };
    const std::uint32_t x = pixel((io.MousePos.x - place.x) / place.width, frame.width);
    const std::uint32_t y = pixel((io.MousePos.y - place.y) / place.height, frame.height);
    state.picked = pick_triangle(*state.shown_model(), frame.moment,
                                 {frame.camera, frame.width, frame.height}, x, y);
    if (state.picked && state.tab != PanelTab::kClusters) state.tab = PanelTab::kPick;
    return true;
  }
  return false;
}

}  // namespace mdk
