// The time line: play, step, loop, speed and clip, and below them the clip as a strip to scrub
// along: keys, segments, the chosen range, and what pictures cost.
//
//     range lane   |      [=========]          |   drag: choose a range, or move an end of it
//     keys         |  '   '   '   |   '   '   '|   drag: the time
//     cost         |  ___---___----____        |
//     segments     |===============|===========|   where there are several
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "common/trace/technique.h"
#include "viewer/panel/panel.h"
#include "viewer/panel/widgets.h"
#include "viewer/state/layout.h"

namespace mdk {
namespace {

// Between the clip's seconds and the window's x.
struct TimeScale {
  Rect strip;
  double seconds = 0;

  float x_of(double time) const {
    const double part = seconds > 0 ? time / seconds : 0;
    return strip.x + strip.width * static_cast<float>(part);
  }
  double time_of(float x) const {
    return static_cast<double>((x - strip.x) / strip.width) * seconds;
  }
};

Rect lane(const Rect& strip, float from, float to) {
  return {strip.x, strip.y + strip.height * from, strip.width, strip.height * (to - from)};
}

// Ticks at the keys; where they would touch, only every n-th.
void draw_keys(const Rect& place, const TimeScale& scale, const Theme& theme,
               const std::vector<double>& times) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float apart = place.width / static_cast<float>(times.size());
  const auto stride =
      static_cast<std::size_t>(std::max(1.0f, std::ceil(4 * theme.scale / std::max(apart, 1e-6f))));
  for (std::size_t i = 0; i < times.size(); i += stride) {
    const float x = scale.x_of(times[i]);
    const bool tall = (i / stride) % 5 == 0;
    draw.AddLine({x, place.y + (tall ? 0 : place.height * 0.4f)}, {x, place.bottom()},
                 faded(dim_color(), tall ? 1.0f : 0.6f), 1.2f * theme.scale);
  }
}

// Stretches of the clip with boxes of their own.
void draw_segments(const Rect& place, const TimeScale& scale, const Theme& theme,
                   const ViewState& state, UiResult& result) {
  const ModelView& model = *state.model();
  const Clip& clip = model.clips[state.playback.clip()];
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  std::size_t number = 0;
  for (const Segment& segment : model.segments) {
    const std::uint32_t first = std::max(segment.first_key, clip.first_key);
    const std::uint32_t last = std::min(segment.last_key, clip.first_key + clip.key_count - 1);
    if (first >= last) continue;
    const float gap = theme.scale;
    const Rect bar{scale.x_of(model.key_times[first]) + gap, place.y,
                   scale.x_of(model.key_times[last]) - scale.x_of(model.key_times[first]) - 2 * gap,
                   place.height};
    draw.AddRectFilled({bar.x, bar.y}, {bar.x + std::max(1.0f, bar.width), bar.bottom()},
                       faded(accent_color(), number % 2 == 0 ? 0.75f : 0.4f), 2 * theme.scale);
    result.widgets["segment:" + std::to_string(number++)] = bar;
  }
}

void draw_curve(const Rect& place, const TimeScale& scale, const CostCurves& costs,
                std::size_t technique, double top_ms) {
  std::vector<ImVec2> points;
  const auto curve = costs.curve(technique);
  for (std::size_t i = 0; i < curve.size(); ++i)
    if (curve[i])
      points.push_back({scale.x_of(costs.moments()[i]),
                        place.bottom() - place.height * static_cast<float>(*curve[i] / top_ms)});
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddPolyline(points.data(), static_cast<int>(points.size()), technique_color(technique),
                   ImDrawFlags_None, 1.5f);
}

// The shown technique's curve fills the height; others are faint, and cut off where they cost more.
void draw_costs(const Rect& place, const TimeScale& scale, const Theme& theme,
                const ViewState& state) {
  const CostCurves& costs = state.cost_curves;
  const std::size_t shown = state.settings.technique;
  double top_ms = costs.longest_ms(shown) * 1.25;
  for (std::size_t t = 0; top_ms == 0 && t < costs.technique_count(); ++t)
    top_ms = costs.longest_ms(t) * 1.25;
  if (!(top_ms > 0)) return;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.PushClipRect({place.x, place.y}, {place.right(), place.bottom()}, true);
  for (std::size_t t = 0; t < costs.technique_count(); ++t)
    if (t != shown) draw_curve(place, scale, costs, t, top_ms);
  // A layer over the others makes them faint, whatever their colours.
  draw.AddRectFilled({place.x, place.y}, {place.right(), place.bottom()},
                     faded(sunken_color(), 0.6f));
  draw_curve(place, scale, costs, shown, top_ms);
  draw.PopClipRect();
  const float size = ImGui::GetFontSize() * 0.76f;
  const std::string top = milliseconds_text(costs.longest_ms(shown));
  if (costs.known(shown) > 0)
    draw.AddText(ImGui::GetFont(), size, {place.x + 5 * theme.scale, place.y - 2 * theme.scale},
                 dim_color(), top.c_str());
}

// What lies under the pointer.
void show_moment(const ViewState& state, double time) {
  const CostCurves& costs = state.cost_curves;
  const auto& moments = costs.moments();
  const double at = std::clamp(time, 0.0, state.playback.seconds());
  const auto after = std::lower_bound(moments.begin(), moments.end(), at);
  ImGui::BeginTooltip();
  ImGui::Text("%.3f s", at);
  if (after != moments.end()) {
    const auto moment = static_cast<std::size_t>(after - moments.begin());
    for (std::size_t t = 0; t < costs.technique_count(); ++t) {
      const auto curve = costs.curve(t);
      if (curve.empty() || !curve[moment]) continue;
      const std::string line = std::string(technique_table()[t].label) + "  " +
                               milliseconds_text(*curve[moment]) + " to image";
      ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(technique_color(t)), "%s", line.c_str());
    }
  }
  ImGui::EndTooltip();
}

void draw_range(const Rect& place, const TimeScale& scale, const Theme& theme,
                const Playback& playback) {
  if (!playback.range()) return;
  const float from = scale.x_of(playback.range()->begin), to = scale.x_of(playback.range()->end);
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float edge = scale.strip.bottom();
  draw.AddRectFilled({from, place.y}, {to, edge}, faded(warning_color(), 0.10f));
  draw.AddRectFilled({from, place.y}, {to, place.bottom()}, faded(warning_color(), 0.55f),
                     2 * theme.scale);
  for (const float x : {from, to})
    draw.AddLine({x, place.y}, {x, edge}, warning_color(), 1.5f * theme.scale);
}

// Dragging chooses a range of keys, or moves the end it began at.
void handle_range_lane(const Rect& place, const TimeScale& scale, const Theme& theme,
                       Playback& playback, UiResult& result) {
  ImGui::SetCursorScreenPos({place.x, place.y});
  hit_area("##range", {place.width, place.height});
  record(result.widgets, "range-lane");
  if (ImGui::IsItemHovered()) {
    ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    ImGui::SetTooltip("Drag to choose a range; a right click clears it (I, O, X)");
    if (ImGui::IsMouseClicked(ImGuiMouseButton_Right)) playback.clear_range();
  }
  // The end that stays: where the drag began, or the other end where it took hold of one.
  ImGuiStorage& memory = *ImGui::GetStateStorage();
  const ImGuiID anchor_id = ImGui::GetID("##range-anchor");
  const float pointer = ImGui::GetIO().MousePos.x;
  if (ImGui::IsItemActivated()) {
    float anchor = pointer;
    if (const auto& range = playback.range()) {
      const float begin = scale.x_of(range->begin), end = scale.x_of(range->end);
      const float near = 6 * theme.scale;
      if (std::abs(pointer - begin) < near) anchor = end;
      if (std::abs(pointer - end) < near) anchor = begin;
    }
    memory.SetFloat(anchor_id, anchor);
  }
  if (!ImGui::IsItemActive() || !ImGui::IsMouseDragging(ImGuiMouseButton_Left)) return;
  playback.set_range(playback.nearest_key_time(scale.time_of(memory.GetFloat(anchor_id))),
                     playback.nearest_key_time(scale.time_of(pointer)));
}

void handle_scrubbing(const Rect& place, const TimeScale& scale, ViewState& state,
                      UiResult& result) {
  Playback& playback = state.playback;
  ImGui::SetCursorScreenPos({place.x, place.y});
  hit_area("##time-line", {place.width, place.height});
  record(result.widgets, "time-line");
  const double pointed = scale.time_of(ImGui::GetIO().MousePos.x);
  if (ImGui::IsItemActive()) {
    playback.begin_scrub();
    playback.seek(pointed);
  } else if (playback.scrubbing()) {
    playback.end_scrub();
  }
  if (ImGui::IsItemHovered()) show_moment(state, pointed);
}

void draw_head(const TimeScale& scale, const Theme& theme, double time) {
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const float head = scale.x_of(time), top = scale.strip.y;
  draw.AddLine({head, top}, {head, scale.strip.bottom()}, accent_color(), 2 * theme.scale);
  const float knob = 5.5f * theme.scale;
  draw.AddTriangleFilled({head - knob, top}, {head + knob, top}, {head, top + 1.5f * knob},
                         accent_color());
}

// Fills what is left of the window. Dragging holds the time; letting go plays on.
void draw_time_track(const Theme& theme, ViewState& state, UiResult& result) {
  const ImVec2 corner = ImGui::GetCursorScreenPos(), size = ImGui::GetContentRegionAvail();
  const float inset = 10 * theme.scale;
  if (size.x <= 2 * inset || size.y <= 4) return;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(corner, {corner.x + size.x, corner.y + size.y}, sunken_color(),
                     5 * theme.scale);
  if (!state.file || state.playback.clips().empty()) return;

  const Rect strip{corner.x + inset, corner.y, size.x - 2 * inset, size.y};
  const TimeScale scale{strip, state.playback.seconds()};
  const Rect range_lane = lane(strip, 0, 0.17f);
  handle_range_lane(range_lane, scale, theme, state.playback, result);
  handle_scrubbing({corner.x, range_lane.bottom(), size.x, strip.bottom() - range_lane.bottom()},
                   scale, state, result);
  if (scale.seconds > 0) {
    const auto& times = state.playback.clips()[state.playback.clip()].key_times;
    draw_keys(lane(strip, 0.2f, 0.40f), scale, theme, times);
    draw_costs(lane(strip, 0.46f, 0.91f), scale, theme, state);
    draw_segments(lane(strip, 0.94f, 0.99f), scale, theme, state, result);
    draw_range(range_lane, scale, theme, state.playback);
  }
  draw_head(scale, theme, state.playback.time());
}

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
    record(result.widgets, name, tip);
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
  if (right - entry < left) {  // no space: leave it out whole
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
  begin_docked("##time", place, ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse);
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
