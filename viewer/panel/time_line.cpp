#include "viewer/panel/time_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "viewer/panel/ui_parts.h"

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
    ImGui::SameLine(0, 3 * theme.scale);
  };
  button("start", Icon::kStart, Command::kStart, "To the start (Home)");
  button("previous-key", Icon::kPreviousKey, Command::kPreviousKey, "Previous key (Left)");
  button("play", playback.playing() ? Icon::kPause : Icon::kPlay, Command::kPlayPause,
         playback.playing() ? "Pause (Space)" : "Play (Space)");
  button("next-key", Icon::kNextKey, Command::kNextKey, "Next key (Right)");
  button("end", Icon::kEnd, Command::kEnd, "To the end (End)");
}

void draw_choices(const Theme& theme, Playback& playback, UiResult& result) {
  ImGui::SameLine(0, 12 * theme.scale);
  ImGui::SetNextItemWidth(100 * theme.scale);
  int loop = static_cast<int>(playback.loop());
  if (ImGui::Combo("##loop", &loop, kLoops.data(), static_cast<int>(kLoops.size())))
    playback.set_loop(static_cast<LoopMode>(loop));
  record(result.widgets, "loop");

  ImGui::SameLine();
  ImGui::SetNextItemWidth(78 * theme.scale);
  if (ImGui::BeginCombo("##speed", speed_text(playback.speed()).c_str())) {
    for (const double speed : kSpeeds)
      if (ImGui::Selectable(speed_text(speed).c_str(), speed == playback.speed()))
        playback.set_speed(speed);
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

void draw_time_text(const Theme& theme, const Playback& playback) {
  if (playback.clips().empty()) return;
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.3f / %.3f s    key %zu of %zu", playback.time(),
                playback.seconds(), playback.key() + 1,
                playback.clips()[playback.clip()].key_times.size());
  const float width = ImGui::CalcTextSize(text.data()).x;
  const float right = ImGui::GetWindowContentRegionMax().x - width;
  ImGui::SameLine();
  if (right < ImGui::GetCursorPosX() + 8 * theme.scale) {  // no room: leave it out whole
    ImGui::NewLine();
    return;
  }
  ImGui::SetCursorPosX(right);
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("%s", text.data());
}

// Ticks at the keys; where they would touch, only every n-th.
void draw_key_ticks(const Rect& track, const Theme& theme, const Playback& playback) {
  const auto& times = playback.clips()[playback.clip()].key_times;
  const double seconds = playback.seconds();
  if (!(seconds > 0)) return;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float apart = track.width / static_cast<float>(times.size());
  const auto stride =
      static_cast<std::size_t>(std::max(1.0f, std::ceil(4 * theme.scale / std::max(apart, 1e-6f))));
  for (std::size_t i = 0; i < times.size(); i += stride) {
    const float x = track.x + track.width * static_cast<float>(times[i] / seconds);
    const bool tall = (i / stride) % 5 == 0;
    const float top = track.y + track.height * (tall ? 0.25f : 0.42f);
    draw.AddLine({x, top}, {x, track.y + track.height * 0.75f},
                 faded(dim_color(), tall ? 1.0f : 0.6f), 1.2f * theme.scale);
  }
}

void draw_track(const Theme& theme, Playback& playback, UiResult& result) {
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec2 size{ImGui::GetContentRegionAvail().x, ImGui::GetContentRegionAvail().y};
  if (size.x <= 0 || size.y <= 0) return;
  ImGui::InvisibleButton("##time-line", size);
  record(result.widgets, "time-line");
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(corner, {corner.x + size.x, corner.y + size.y}, sunken_color(),
                     5 * theme.scale);
  if (playback.clips().empty()) return;

  const float inset = 10 * theme.scale;
  const Rect track{corner.x + inset, corner.y, std::max(1.0f, size.x - 2 * inset), size.y};
  if (ImGui::IsItemActive()) {
    playback.begin_scrub();
    playback.seek(static_cast<double>((ImGui::GetIO().MousePos.x - track.x) / track.width) *
                  playback.seconds());
  } else if (playback.scrubbing()) {
    playback.end_scrub();
  }

  const double part = playback.seconds() > 0 ? playback.time() / playback.seconds() : 0;
  const float head = track.x + track.width * static_cast<float>(part);
  draw.AddRectFilled({corner.x, corner.y}, {head, corner.y + size.y}, faded(accent_color(), 0.13f),
                     5 * theme.scale, ImDrawFlags_RoundCornersLeft);
  draw_key_ticks(track, theme, playback);
  draw.AddLine({head, corner.y}, {head, corner.y + size.y}, accent_color(), 2 * theme.scale);
  const float knob = 5.5f * theme.scale;
  draw.AddTriangleFilled({head - knob, corner.y}, {head + knob, corner.y},
                         {head, corner.y + 1.5f * knob}, accent_color());
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
  draw_transport(theme, state.playback, result);
  draw_choices(theme, state.playback, result);
  draw_time_text(theme, state.playback);
  draw_track(theme, state.playback, result);
  ImGui::End();
}

}  // namespace mdk
