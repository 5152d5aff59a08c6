#include "viewer/panel/time_line.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "viewer/panel/time_track.h"
#include "viewer/panel/ui_parts.h"
#include "viewer/state/time_line_rows.h"

namespace mdk {
namespace {

constexpr std::array kSpeeds = {0.1, 0.25, 0.5, 1.0, 2.0, 4.0};
constexpr std::array kLoops = {"Once", "Loop", "Ping-pong"};

std::string speed_text(double speed) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g x", speed);
  return text.data();
}

void draw_transport(const Theme& theme, const Playback& playback, UiResult& result) {
  const ImVec2 size{30 * theme.scale, ImGui::GetFrameHeight()};
  const auto button = [&](const char* name, Icon icon, Command command, const char* tip) {
    const std::string id = std::string("##") + name;
    if (icon_button(id.c_str(), icon, size)) result.actions.push_back({command});
    record(result.widgets, name);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
  };
  const auto next = [&] { ImGui::SameLine(0, 3 * theme.scale); };
  button("start", Icon::kStart, Command::kStart, "To the start (Home)");
  next();
  button("previous-key", Icon::kPreviousKey, Command::kPreviousKey, "Previous key (Left)");
  next();
  button("play", playback.playing() ? Icon::kPause : Icon::kPlay, Command::kPlayPause,
         playback.playing() ? "Pause (Space)" : "Play (Space)");
  next();
  button("next-key", Icon::kNextKey, Command::kNextKey, "Next key (Right)");
  next();
  button("end", Icon::kEnd, Command::kEnd, "To the end (End)");
}

void draw_choices(const Theme& theme, Playback& playback, UiResult& result) {
  ImGui::SetNextItemWidth(100 * theme.scale);
  const auto loop = static_cast<std::size_t>(playback.loop());
  if (ImGui::BeginCombo("##loop", kLoops[loop])) {
    for (std::size_t i = 0; i < kLoops.size(); ++i) {
      if (ImGui::Selectable(kLoops[i], i == loop)) playback.set_loop(static_cast<LoopMode>(i));
      record(result.widgets, "loop:" + std::to_string(i));
    }
    ImGui::EndCombo();
  }
  record(result.widgets, "loop");

  ImGui::SameLine();
  ImGui::SetNextItemWidth(78 * theme.scale);
  if (ImGui::BeginCombo("##speed", speed_text(playback.speed()).c_str())) {
    for (const double speed : kSpeeds) {
      const std::string text = speed_text(speed);
      if (ImGui::Selectable(text.c_str(), speed == playback.speed())) playback.set_speed(speed);
      record(result.widgets, "speed:" + text);
    }
    ImGui::EndCombo();
  }
  record(result.widgets, "speed");

  ImGui::SameLine();
  const float room = ImGui::GetWindowContentRegionMax().x - ImGui::GetCursorPosX();
  ImGui::SetNextItemWidth(std::clamp(room, 1.0f, 170 * theme.scale));
  const auto& clips = playback.clips();
  const char* shown = clips.empty() ? "no clip" : clips[playback.clip()].name.c_str();
  if (ImGui::BeginCombo("##clip", shown)) {
    for (std::size_t i = 0; i < clips.size(); ++i) {
      ImGui::PushID(static_cast<int>(i));
      if (ImGui::Selectable(clips[i].name.c_str(), i == playback.clip())) playback.set_clip(i);
      ImGui::PopID();
      record(result.widgets, "clip:" + clips[i].name);
    }
    ImGui::EndCombo();
  }
  record(result.widgets, "clip");
}

// The time can be typed; Enter goes there. At the right end of the row that has been begun.
void draw_time_entry(const Theme& theme, Playback& playback, UiResult& result) {
  if (playback.clips().empty()) return;
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "/ %.3f s    key %zu of %zu", playback.seconds(),
                playback.key() + 1, playback.clips()[playback.clip()].key_times.size());
  const float entry = ImGui::CalcTextSize("0000.000").x + 2 * ImGui::GetStyle().FramePadding.x;
  const float gap = 6 * theme.scale;
  ImGui::SameLine(0, 12 * theme.scale);
  const float left = ImGui::GetCursorPosX(), right = ImGui::GetWindowContentRegionMax().x;
  const float with_text = right - (entry + gap + ImGui::CalcTextSize(text.data()).x);
  const bool has_text = with_text >= left;
  if (right - entry < left) {  // no room: leave it out whole
    ImGui::NewLine();
    return;
  }
  ImGui::SetCursorPosX(has_text ? with_text : right - entry);
  ImGui::SetNextItemWidth(entry);
  double time = playback.time();
  if (ImGui::InputDouble("##time-entry", &time, 0, 0, "%.3f",
                         ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll))
    playback.seek(time);
  record(result.widgets, "time-entry");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Seconds; type a time and press Enter%s%s", has_text ? "" : "\n",
                      has_text ? "" : text.data());
  if (!has_text) return;
  ImGui::SameLine(0, gap);
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("%s", text.data());
}

}  // namespace

void draw_time_line(const Rect& place, const Theme& theme, ViewState& state, UiResult& result) {
  ImGui::SetNextWindowPos({place.x, place.y});
  ImGui::SetNextWindowSize({place.width, place.height});
  ImGui::Begin("##time", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoBringToFrontOnFocus |
                   ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse |
                   ImGuiWindowFlags_NoNav);
  const bool wraps = time_line_wraps(place.width, theme.scale);
  draw_transport(theme, state.playback, result);
  if (wraps) draw_time_entry(theme, state.playback, result);
  if (!wraps) ImGui::SameLine(0, 12 * theme.scale);
  draw_choices(theme, state.playback, result);
  if (!wraps) draw_time_entry(theme, state.playback, result);
  draw_time_track(theme, state, result);
  ImGui::End();
}

}  // namespace mdk
