#include "viewer/state/picture_mouse.h"

#include <imgui.h>

namespace mdk {

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

}  // namespace mdk
