#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>
#include <string>

#include "common/base/figure_text.h"
#include "common/trace/color.h"
#include "common/trace/shading.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/ui_parts.h"

namespace mdk {
namespace {

enum Column { kNumber, kTriangles, kResidual, kCost, kButtons, kColumns };

void draw_overlay_choices(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "DRAW OVER THE PICTURE");
  OverlaySettings& overlays = state.overlays;
  const float half = ImGui::GetContentRegionAvail().x / 2;
  const float left = ImGui::GetCursorPosX();
  ImGui::Checkbox("World boxes", &overlays.world_boxes);
  record(result.widgets, "world-boxes");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Boxes of the clusters now, along the world's axes");
  ImGui::SameLine(left + half);
  ImGui::Checkbox("Local boxes", &overlays.local_boxes);
  record(result.widgets, "local-boxes");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("Boxes that hold each cluster at every time, in its own basis");
  ImGui::Checkbox("Tree cells", &overlays.tree_cells);
  record(result.widgets, "tree-cells");
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "Cells of the fuzzy kd-trees: of the cluster shown alone,\n"
        "else of the picked triangle's, else of all");
  ImGui::SameLine(left + half);
  ImGui::SetNextItemWidth(-1);
  ImGui::SliderInt("##depth", &overlays.tree_depth, 0, kMostTreeDepth, "depth %d",
                   ImGuiSliderFlags_AlwaysClamp);
  record(result.widgets, "tree-depth");
}

std::string percent(double part) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), part < 0.0995 ? "%.2f %%" : "%.1f %%", 100 * part);
  return text.data();
}

std::vector<std::uint32_t> sorted_clusters(const std::vector<ClusterFacts>& facts) {
  std::vector<std::uint32_t> order(facts.size());
  std::iota(order.begin(), order.end(), 0u);
  const ImGuiTableSortSpecs* specs = ImGui::TableGetSortSpecs();
  if (!specs || specs->SpecsCount == 0) return order;
  const ImGuiTableColumnSortSpecs& by = specs->Specs[0];
  const auto value = [&](std::uint32_t c) {
    switch (by.ColumnIndex) {
      case kTriangles:
        return static_cast<double>(facts[c].triangles);
      case kResidual:
        return facts[c].residual;
      case kCost:
        return facts[c].cost_share;
      default:
        return static_cast<double>(c);
    }
  };
  const bool rises = by.SortDirection == ImGuiSortDirection_Ascending;
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return rises ? value(a) < value(b) : value(b) < value(a);
  });
  return order;
}

// A small button that looks pressed while `on`. Whether it was clicked.
bool toggle_button(const char* label, bool on, const std::string& name, UiResult& result) {
  ImGui::PushStyleColor(ImGuiCol_Button, on ? faded(accent_color(), 0.6f) : IM_COL32(0, 0, 0, 0));
  ImGui::PushStyleColor(ImGuiCol_Text, on ? text_color() : dim_color());
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, ImVec2(4, 0));
  const bool clicked = ImGui::SmallButton(label);
  ImGui::PopStyleVar();
  ImGui::PopStyleColor(2);
  record(result.widgets, name);
  return clicked;
}

void draw_row(std::uint32_t c, const ClusterFacts& facts, ViewState& state, UiResult& result) {
  const std::string name = "cluster:" + std::to_string(c);
  const bool shown = state.clusters.shown(c), picked = state.picked && state.picked->cluster == c;
  ImGui::PushID(static_cast<int>(c));
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float line = ImGui::GetTextLineHeight();
  // The row as a whole takes the pointer; its buttons lie above it.
  ImGui::Selectable("##row", picked,
                    ImGuiSelectableFlags_SpanAllColumns | ImGuiSelectableFlags_AllowItemOverlap);
  if (ImGui::IsItemHovered()) state.clusters.hovered = c;
  record(result.widgets, name);
  const ImU32 color = pack_srgb(cluster_color(c));
  ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + 2}, {at.x + line - 4, at.y + line - 2},
                                            shown ? color : faded(color, 0.3f), 3);
  ImGui::SameLine(0, 0);
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + line + 2);
  ImGui::PushStyleColor(ImGuiCol_Text, shown ? text_color() : dim_color());
  ImGui::Text("%u", c);
  for (const std::string& text :
       {grouped_text(facts.triangles), percent(facts.residual), percent(facts.cost_share)}) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(text.c_str());
  }
  ImGui::PopStyleColor();
  ImGui::TableNextColumn();
  if (toggle_button("solo", state.clusters.solo() == c, name + ":solo", result))
    state.clusters.toggle_solo(c);
  ImGui::SameLine(0, 2);
  if (toggle_button("hide", state.clusters.hidden(c), name + ":hide", result))
    state.clusters.toggle_hidden(c);
  ImGui::PopID();
}

void draw_table(const Theme& theme, ViewState& state, UiResult& result) {
  const float height = std::max(120 * theme.scale, ImGui::GetContentRegionAvail().y);
  ImGui::PushStyleVar(ImGuiStyleVar_CellPadding, ImVec2(2 * theme.scale, theme.scale));
  if (ImGui::BeginTable("##clusters", kColumns,
                        ImGuiTableFlags_Sortable | ImGuiTableFlags_ScrollY | ImGuiTableFlags_RowBg,
                        {0, height})) {
    const float unit = theme.scale;
    ImGui::TableSetupScrollFreeze(0, 1);
    const auto column = [&](const char* title, float width, ImGuiTableColumnFlags flags) {
      ImGui::TableSetupColumn(title, ImGuiTableColumnFlags_WidthFixed | flags, width * unit);
    };
    column("no.", 44, ImGuiTableColumnFlags_None);
    column("tris", 50, ImGuiTableColumnFlags_PreferSortDescending);
    column("residual", 76, ImGuiTableColumnFlags_PreferSortDescending);
    column("cost", 54, ImGuiTableColumnFlags_PreferSortDescending);
    column("##show", 72, ImGuiTableColumnFlags_NoSort);
    ImGui::TableNextRow(ImGuiTableRowFlags_Headers);
    for (int i = 0; i < kButtons; ++i) {
      ImGui::TableSetColumnIndex(i);
      ImGui::TableHeader(ImGui::TableGetColumnName(i));
      record(result.widgets, std::string("sort:") + ImGui::TableGetColumnName(i));
    }
    const std::vector<ClusterFacts>& facts = state.clusters.facts();
    for (const std::uint32_t c : sorted_clusters(facts)) draw_row(c, facts[c], state, result);
    ImGui::EndTable();
    record(result.widgets, "clusters-table");
  }
  ImGui::PopStyleVar();
}

}  // namespace

void draw_clusters_tab(const Theme& theme, ViewState& state, UiResult& result) {
  draw_overlay_choices(theme, state, result);
  heading(theme, "CLUSTERS");
  if (!state.file) {
    ImGui::TextDisabled("none: no file is open");
    return;
  }
  const std::uint32_t count = state.model()->cluster_count();
  ImGui::AlignTextToFramePadding();
  ImGui::TextDisabled("%u of %u shown", state.clusters.shown_count(), count);
  const float button = 80 * theme.scale;
  ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - button);
  if (ImGui::Button("Show all", {button, 0})) state.clusters.show_all();
  record(result.widgets, "show-all");
  draw_table(theme, state, result);
}

}  // namespace mdk
