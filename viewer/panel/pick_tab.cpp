#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include "common/base/figure_text.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

std::string percent(double part) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g %%", 100 * part);
  return text.data();
}

double residual_at(const ResidualCurve& curve, double seconds) {
  const auto after = std::upper_bound(curve.seconds.begin(), curve.seconds.end(), seconds);
  if (after == curve.seconds.begin()) return curve.residuals.front();
  return curve.residuals[static_cast<std::size_t>(after - curve.seconds.begin()) - 1];
}

// Residuals of the keys over the clip, and where the picture stands.
void draw_curve(const Theme& theme, const ResidualCurve& curve, double seconds, UiResult& result) {
  const ImVec2 lo = ImGui::GetCursorScreenPos();
  const ImVec2 size{ImGui::GetContentRegionAvail().x, 110 * theme.scale};
  const ImVec2 hi{lo.x + size.x, lo.y + size.y};
  hit_area("##residuals", size);
  record(result.widgets, "residual-plot");
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(lo, hi, sunken_color(), 5 * theme.scale);
  const double top = *std::max_element(curve.residuals.begin(), curve.residuals.end());
  const double length = curve.seconds.back();
  const float inset = 6 * theme.scale, title = ImGui::GetTextLineHeight();
  const auto point = [&](double s, double residual) {
    const double across = length > 0 ? s / length : 0, up = top > 0 ? residual / top : 0;
    const float room = size.y - 2 * inset - title;
    return ImVec2(lo.x + inset + (size.x - 2 * inset) * static_cast<float>(across),
                  hi.y - inset - room * static_cast<float>(up));
  };
  std::vector<ImVec2> points;
  for (std::size_t i = 0; i < curve.seconds.size(); ++i)
    points.push_back(point(curve.seconds[i], curve.residuals[i]));
  const ImVec2 head = point(seconds, 0);
  draw.AddLine({head.x, lo.y + inset}, {head.x, hi.y - inset}, faded(accent_color(), 0.6f),
               theme.scale);
  draw.AddPolyline(points.data(), static_cast<int>(points.size()), accent_color(), ImDrawFlags_None,
                   1.6f * theme.scale);
  draw.AddText({lo.x + inset, lo.y + inset / 2}, dim_color(), ("up to " + percent(top)).c_str());
}

void draw_facts(const ViewState& state, const PickedTriangle& picked, double residual) {
  const Model& model = *state.model();
  const std::uint32_t segment =
      segment_of(model, state.last_frame ? state.last_frame->moment : Moment{});
  const Aabb box = model.fuzzy_box(segment, picked.cluster, picked.triangle);
  fact("Triangle", grouped_text(picked.triangle));
  fact("Its number in the input", grouped_text(model.source_triangles[picked.triangle]));
  fact("Cluster", grouped_text(picked.cluster));
  fact("Residual at the key before", percent(residual));
  const double unit = model.rest_diagonal > 0 ? model.rest_diagonal : 1;
  const Vec3f size = box.extent();
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.2g x %.2g x %.2g %%",
                100 * static_cast<double>(size.x) / unit, 100 * static_cast<double>(size.y) / unit,
                100 * static_cast<double>(size.z) / unit);
  fact("Fuzzy box", text.data());
}

void draw_choices(const Theme& theme, ViewState& state, const PickedTriangle& picked,
                  UiResult& result) {
  heading(theme, "DRAW OVER THE PICTURE");
  ImGui::Checkbox("Its fuzzy box, which holds it at every time", &state.overlays.fuzzy_box);
  record(result.widgets, "fuzzy-box");
  ImGui::Checkbox("Its cluster's basis", &state.overlays.local_basis);
  record(result.widgets, "local-basis");
  heading(theme, "ITS CLUSTER");
  const bool alone = state.clusters.solo() == picked.cluster;
  const float half = (ImGui::GetContentRegionAvail().x - ImGui::GetStyle().ItemSpacing.x) / 2;
  if (ImGui::Button(alone ? "Show all" : "Show alone", {half, 0}))
    state.clusters.toggle_solo(picked.cluster);
  record(result.widgets, "pick:solo");
  ImGui::SameLine();
  if (ImGui::Button(state.clusters.hidden(picked.cluster) ? "Unhide" : "Hide", {half, 0}))
    state.clusters.toggle_hidden(picked.cluster);
  record(result.widgets, "pick:hide");
}

}  // namespace

void draw_pick_tab(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "PICKED TRIANGLE");
  if (!state.file || !state.picked) {
    ImGui::PushTextWrapPos(0);
    ImGui::TextDisabled(
        "Click on the model: the triangle under the pointer, its cluster, and how far its motion "
        "is from what the cluster's map explains.");
    ImGui::PopTextWrapPos();
    return;
  }
  const PickedTriangle picked = *state.picked;
  const auto clip = static_cast<std::uint32_t>(state.playback.clip());
  const ResidualCurve& curve = state.residuals.curve(*state.model(), clip, picked.triangle);
  draw_facts(state, picked, residual_at(curve, state.playback.time()));
  heading(theme, "RESIDUAL OVER THE CLIP");
  draw_curve(theme, curve, state.playback.time(), result);
  draw_choices(theme, state, picked, result);
}

}  // namespace mdk
