// Pages about the model: Clusters, Pick and File.
#include <algorithm>
#include <array>
#include <cstdio>
#include <numeric>
#include <string>

#include "common/base/text.h"
#include "common/trace/color.h"
#include "common/trace/shading.h"
#include "formats/files/file_kind.h"
#include "viewer/panel/tabs.h"
#include "viewer/panel/widgets.h"

namespace mdk {
namespace {

std::string percent(double part) { return fixed_text(100 * part, part < 0.0995 ? 2 : 1) + " %"; }

/// To three digits, however small.
std::string residual_percent(double residual) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g %%", 100 * residual);
  return text.data();
}

enum Column { kNumber, kTriangles, kResidual, kCost, kButtons, kColumns };

void draw_overlay_choices(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "DRAW OVER THE PICTURE");
  OverlaySettings& overlays = state.overlays;
  const float half = ImGui::GetContentRegionAvail().x / 2;
  const float left = ImGui::GetCursorPosX();
  checkbox("World boxes", overlays.world_boxes, result.widgets, "world-boxes",
           "Boxes of the clusters now, along the world's axes");
  ImGui::SameLine(left + half);
  checkbox("Local boxes", overlays.local_boxes, result.widgets, "local-boxes",
           "Boxes that hold each cluster at every time, in its own basis");
  checkbox("Tree cells", overlays.tree_cells, result.widgets, "tree-cells",
           "Cells of the fuzzy kd-trees: of the cluster shown alone,\n"
           "else of the picked triangle's, else of all");
  ImGui::SameLine(left + half);
  ImGui::SetNextItemWidth(-1);
  ImGui::SliderInt("##depth", &overlays.tree_depth, 0, kMaxTreeDepth, "depth %d",
                   ImGuiSliderFlags_AlwaysClamp);
  record(result.widgets, "tree-depth");
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
  cell(grouped_text(facts.triangles));
  cell(percent(facts.residual));
  cell(percent(facts.cost_share));
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
  draw.AddText({lo.x + inset, lo.y + inset / 2}, dim_color(),
               ("up to " + residual_percent(top)).c_str());
}

void draw_pick_facts(const ViewState& state, const PickedTriangle& picked, double residual) {
  const ModelView& model = *state.model();
  const std::uint32_t segment =
      segment_of(model, state.frames.last ? state.frames.last->moment : Moment{});
  const Aabb box = model.fuzzy_box(segment, picked.cluster, picked.triangle);
  fact("Triangle", grouped_text(picked.triangle));
  fact("Its number in the input", grouped_text(model.source_triangles[picked.triangle]));
  fact("Cluster", grouped_text(picked.cluster));
  fact("Residual at the key before", residual_percent(residual));
  const double unit = model.rest_diagonal > 0 ? model.rest_diagonal : 1;
  const Vec3f size = box.extent();
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "%.2g x %.2g x %.2g %%",
                100 * static_cast<double>(size.x) / unit, 100 * static_cast<double>(size.y) / unit,
                100 * static_cast<double>(size.z) / unit);
  fact("Fuzzy box", text.data());
}

void draw_pick_choices(const Theme& theme, ViewState& state, const PickedTriangle& picked,
                       UiResult& result) {
  heading(theme, "DRAW OVER THE PICTURE");
  checkbox("Its fuzzy box, which holds it at every time", state.overlays.fuzzy_box, result.widgets,
           "fuzzy-box");
  checkbox("Its cluster's basis", state.overlays.local_basis, result.widgets, "local-basis");
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

void draw_file_facts(const Theme& theme, const ViewState& state) {
  heading(theme, "FILE");
  const ModelView* model = state.model();
  if (!model) {
    ImGui::TextDisabled("Drop an animation on the window.");
    return;
  }
  std::array<char, 32> seconds{};
  std::snprintf(seconds.data(), seconds.size(), "%.3g s", state.playback.seconds());
  fact("Triangles", grouped_text(model->triangle_count()));
  fact("Vertices", grouped_text(model->vertex_count));
  fact("Clips", grouped_text(model->clips.size()));
  fact("Keys", grouped_text(model->key_count()));
  fact("This clip", seconds.data());
  fact("Clusters", grouped_text(model->cluster_count()));
  fact("Time segments", grouped_text(model->segment_count()));
  fact("Joints to pose", grouped_text(model->skeleton.joints.size()));
  fact("Textures", grouped_text(model->appearance.textures.size()));
  fact("Size", bytes_text(state.file->file_bytes()));
}

void draw_saving(const Theme& theme, UiResult& result) {
  heading(theme, "SAVE");
  button_row(
      {{"save-picture-as-png", "Picture", "The picture alone, as PNG (P)", Command::kSavePicture},
       {"save-window", "Window", "The whole window, as PNG (Shift + P)", Command::kSaveWindow},
       {"copy-command", "Command",
        "Copy the mdprep render command that makes this picture, to the pixel (C)",
        Command::kCopyCommand}},
      result);
}

void draw_export(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "EXPORT");
  ExportSettings& settings = state.export_settings;
  if (settings.films_possible)
    choose({{"export-pictures", "Pictures"}, {"export-film", "Film"}}, settings.kind,
           result.widgets);
  if (state.exporting) {
    ImGui::ProgressBar(static_cast<float>(state.exporting->fraction), {-1, 6 * theme.scale}, "");
    record(result.widgets, "export-progress");
    button_row(
        {{"cancel-export", "Cancel", "Takes away what was written (Esc)", Command::kCancelExport}},
        result);
    return;
  }
  const bool part = state.playback.range().has_value();
  button_row({{"export", part ? "Export the range" : "Export the clip",
               "Every key as seen now, by mdprep in the background, into the current folder (E)",
               Command::kExport}},
             result);
}

void draw_opening(const Theme& theme, const ViewState& state, UiResult& result) {
  heading(theme, "OPEN");
  std::vector<CommandButton> buttons = {
      {"open", "Open or recent", "Recent files, or a path (L)", Command::kToggleFileMenu}};
  if (state.file && file_kind(state.path) != FileKind::kBaked)
    buttons.push_back({"keep-baked", "Keep as .mdk",
                       "Write what was baked beside its source: that opens at once",
                       Command::kKeepBaked});
  button_row(buttons, result);
}

void draw_window_choices(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "WINDOW");
  choose({{"theme:dark", "Dark"}, {"theme:light", "Light"}}, state.settings.colors, result.widgets);
  checkbox("Turntable", state.turntable, result.widgets, "turntable",
           "The camera goes slowly round (T)");
  const float room = ImGui::GetContentRegionAvail().x, gap = ImGui::GetStyle().ItemSpacing.x;
  ImGui::SameLine(ImGui::GetCursorPosX() + (room + gap) / 2);
  button_row({{"text-smaller", "Text -", "Smaller text and buttons (-)", Command::kSmallerText},
              {"text-larger", "Text +", "Larger text and buttons (+)", Command::kLargerText}},
             result);
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

void draw_pick_tab(const Theme& theme, ViewState& state, UiResult& result) {
  heading(theme, "PICKED TRIANGLE");
  if (!state.file || !state.picked) {
    dim_paragraph(
        "Click on the model: the triangle under the pointer, its cluster, and how far its motion "
        "is from what the cluster's map explains.");
    return;
  }
  const PickedTriangle picked = *state.picked;
  const auto clip = static_cast<std::uint32_t>(state.playback.clip());
  const ResidualCurve& curve = state.residuals.curve(*state.model(), clip, picked.triangle);
  draw_pick_facts(state, picked, residual_at(curve, state.playback.time()));
  heading(theme, "RESIDUAL OVER THE CLIP");
  draw_curve(theme, curve, state.playback.time(), result);
  draw_pick_choices(theme, state, picked, result);
}

void draw_file_tab(const Theme& theme, ViewState& state, UiResult& result) {
  draw_file_facts(theme, state);
  draw_opening(theme, state, result);
  draw_saving(theme, result);
  draw_export(theme, state, result);
  draw_window_choices(theme, state, result);
}

}  // namespace mdk
