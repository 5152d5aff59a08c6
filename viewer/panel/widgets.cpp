#include "viewer/panel/widgets.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/base/text.h"

namespace mdk {

void record(WidgetMap& widgets, const std::string& name, const char* tip) {
  const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
  widgets[name] = {lo.x, lo.y, hi.x - lo.x, hi.y - lo.y};
  if (tip && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tip);
}

bool hit_area(const char* id, const ImVec2& size) {
  return ImGui::InvisibleButton(id, {std::max(size.x, 1.0f), std::max(size.y, 1.0f)});
}

void heading(const Theme& theme, const char* title) {
  ImGui::Dummy({0, 3 * theme.scale});
  ImGui::PushFont(theme.fonts.strong);
  const float size = ImGui::GetFontSize() * 0.76f;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::GetWindowDrawList()->AddText(theme.fonts.strong, size, corner, dim_color(), title);
  const ImVec2 extent = theme.fonts.strong->CalcTextSizeA(size, 1e4f, 0, title);
  const float y = std::floor(corner.y + extent.y / 2) + 0.5f;
  ImGui::GetWindowDrawList()->AddLine({corner.x + extent.x + 9 * theme.scale, y},
                                      {corner.x + ImGui::GetContentRegionAvail().x, y},
                                      line_color());
  ImGui::PopFont();
  ImGui::Dummy({0, size});
}

void fact(const char* name, const std::string& value) {
  ImGui::TextDisabled("%s", name);
  const float width = ImGui::CalcTextSize(value.c_str()).x;
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - width);
  ImGui::TextUnformatted(value.c_str());
}

void cell(const std::string& text) {
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(text.c_str());
}

void colored_text(ImU32 color, const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopStyleColor();
}

void dim_paragraph(const std::string& text) {
  ImGui::PushTextWrapPos(0);
  ImGui::TextDisabled("%s", text.c_str());
  ImGui::PopTextWrapPos();
}

void checkbox(const char* label, bool& on, WidgetMap& widgets, const char* name, const char* tip) {
  ImGui::Checkbox(label, &on);
  record(widgets, name, tip);
}

std::optional<std::size_t> segmented_buttons(const std::vector<ButtonSegment>& segments,
                                             std::size_t chosen, WidgetMap& widgets) {
  if (segments.empty()) return {};
  constexpr float kGap = 2;
  const auto count = static_cast<float>(segments.size());
  const float width = std::floor((ImGui::GetContentRegionAvail().x - kGap * (count - 1)) / count);
  std::optional<std::size_t> clicked;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    if (i > 0) ImGui::SameLine(0, kGap);
    ImVec4 accent = ImGui::ColorConvertU32ToFloat4(accent_color());
    accent.w = 0.45f;
    if (i == chosen) ImGui::PushStyleColor(ImGuiCol_Button, accent);
    if (i == chosen) ImGui::PushStyleColor(ImGuiCol_ButtonHovered, accent);
    ImGui::PushID(segments[i].id.c_str());
    if (ImGui::Button(segments[i].label.c_str(), {width, 0})) clicked = i;
    ImGui::PopID();
    if (i == chosen) ImGui::PopStyleColor(2);
    record(widgets, segments[i].id);
  }
  return clicked;
}

void button_row(const std::vector<CommandButton>& buttons, UiResult& result) {
  const auto count = static_cast<float>(buttons.size());
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float width = std::floor((ImGui::GetContentRegionAvail().x - gap * (count - 1)) / count);
  for (std::size_t i = 0; i < buttons.size(); ++i) {
    if (i > 0) ImGui::SameLine();
    if (ImGui::Button(buttons[i].label, {width, 0})) result.actions.push_back({buttons[i].command});
    record(result.widgets, buttons[i].id, buttons[i].tip);
  }
}

bool icon_button(const char* id, Icon icon, const ImVec2& size) {
  const bool clicked = ImGui::Button(id, size);
  const ImVec2 lo = ImGui::GetItemRectMin(), hi = ImGui::GetItemRectMax();
  const ImVec2 c{(lo.x + hi.x) / 2, (lo.y + hi.y) / 2};
  const float r = (hi.y - lo.y) * 0.22f;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  const auto triangle = [&](float tip, float base) {
    const ImVec2 a{c.x + base, c.y - r * 1.1f}, b{c.x + base, c.y + r * 1.1f}, t{c.x + tip, c.y};
    // Anti-aliased fills want clockwise corners.
    tip > base ? draw.AddTriangleFilled(a, t, b, text_color())
               : draw.AddTriangleFilled(a, b, t, text_color());
  };
  const auto chevron = [&](float tip) {
    const std::array<ImVec2, 3> points = {ImVec2(c.x - tip * 0.5f, c.y - r),
                                          ImVec2(c.x + tip * 0.5f, c.y),
                                          ImVec2(c.x - tip * 0.5f, c.y + r)};
    draw.AddPolyline(points.data(), static_cast<int>(points.size()), text_color(), ImDrawFlags_None,
                     r * 0.45f);
  };
  const auto bar = [&](float from, float to) {
    draw.AddRectFilled({c.x + from, c.y - r * 1.1f}, {c.x + to, c.y + r * 1.1f}, text_color(),
                       r * 0.2f);
  };
  switch (icon) {
    case Icon::kPlay:
      triangle(r * 1.2f, -r * 0.8f);
      break;
    case Icon::kPause:
      bar(-r, -r * 0.3f);
      bar(r * 0.3f, r);
      break;
    case Icon::kPreviousKey:
      chevron(-r);
      break;
    case Icon::kNextKey:
      chevron(r);
      break;
    case Icon::kStart:
      triangle(-r * 0.6f, r);
      bar(-r, -r * 0.6f);
      break;
    case Icon::kEnd:
      triangle(r * 0.6f, -r);
      bar(r * 0.6f, r);
      break;
  }
  return clicked;
}

FloatingBox::FloatingBox(const char* id, const Theme& theme, ImGuiWindowFlags flags, ImVec2 padding,
                         ImU32 ground) {
  const bool padded = padding.x > 0;
  const ImVec2 own{padding.x * theme.scale, padding.y * theme.scale};
  ImGui::PushStyleColor(ImGuiCol_WindowBg, ground);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, (padded ? 10 : 8) * theme.scale);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, padded ? own : ImGui::GetStyle().WindowPadding);
  ImGui::Begin(id, nullptr, flags);
}

FloatingBox::~FloatingBox() {
  ImGui::End();
  ImGui::PopStyleVar(2);
  ImGui::PopStyleColor();
}

void begin_docked(const char* id, const Rect& place, ImGuiWindowFlags more_flags) {
  ImGui::SetNextWindowPos({place.x, place.y});
  ImGui::SetNextWindowSize({place.width, place.height});
  ImGui::Begin(id, nullptr, kFixedBox | ImGuiWindowFlags_NoBringToFrontOnFocus | more_flags);
}

void center_next_window(const Rect& place) {
  ImGui::SetNextWindowPos({place.x + place.width / 2, place.y + place.height / 2}, ImGuiCond_Always,
                          {0.5f, 0.5f});
}

std::string short_number(double value) {
  return fixed_text(value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0);
}

std::string milliseconds_text(double ms) { return short_number(ms) + " ms"; }

std::string rate_text(double per_second) {
  if (per_second >= 1e9) return fixed_text(per_second / 1e9, 2) + " G";
  if (per_second >= 1e6) return fixed_text(per_second / 1e6, per_second < 1e8 ? 1 : 0) + " M";
  if (per_second >= 1e3) return fixed_text(per_second / 1e3, 0) + " k";
  return fixed_text(per_second, 0);
}

}  // namespace mdk
