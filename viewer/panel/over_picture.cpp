// What lies over the picture: the mouse that moves the view and picks, the names and the divider of
// a comparison, lines of boxes and bases.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "common/trace/color.h"
#include "common/trace/shading.h"
#include "common/trace/technique.h"
#include "viewer/panel/charts.h"
#include "viewer/panel/panel.h"
#include "viewer/panel/widgets.h"
#include "viewer/state/camera.h"

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

bool pick_by_mouse(ViewState& state, const Rect& picture) {
  constexpr float kClickReach = 4;  // window coordinates: a click may slip so far
  const ImGuiIO& io = ImGui::GetIO();
  const bool clicked =
      ImGui::IsMouseReleased(ImGuiMouseButton_Left) && !io.WantCaptureMouse && !io.KeyShift &&
      io.MouseDragMaxDistanceSqr[ImGuiMouseButton_Left] < kClickReach * kClickReach;
  if (!clicked || !state.frames.last) return false;
  const FrameReport& frame = *state.frames.last;
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

namespace {

std::string title_of(const FrameReport& frame) {
  return std::string(technique_table()[frame.technique].label) + "   " +
         milliseconds_text(frame.stats.time_to_image_ms());
}

/// Where a plate begins, or, of one at the right, where it ends.
enum class Anchor { kLeft, kRight };

// A text on a plate.
void draw_plate(const Theme& theme, const ImVec2& at, Anchor anchor, const std::string& text,
                ImU32 dot) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float pad = 8 * theme.scale, mark = 14 * theme.scale;
  const float width = size.x + mark + 2 * pad, height = size.y + pad;
  const float x = anchor == Anchor::kRight ? at.x - width : at.x;
  draw.AddRectFilled({x, at.y}, {x + width, at.y + height}, floating_color(), 6 * theme.scale);
  draw.AddCircleFilled({x + pad + 4 * theme.scale, at.y + height / 2}, 4.5f * theme.scale, dot, 20);
  draw.AddText({x + pad + mark, at.y + pad / 2}, text_color(), text.c_str());
}

void draw_divider(const Rect& picture, const Theme& theme, CompareSettings& compare,
                  UiResult& result) {
  const float grip = 16 * theme.scale;
  const float x = picture.x + compare.divider * picture.width;
  ImGui::SetNextWindowPos({x - grip / 2, picture.y});
  ImGui::SetNextWindowSize({grip, picture.height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, ImVec2(1, 1));
  ImGui::Begin("##divider", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoBackground |
                   ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  hit_area("##grip", {grip, picture.height});
  record(result.widgets, "divider");
  const bool held = ImGui::IsItemActive(), lit = held || ImGui::IsItemHovered();
  const ImU32 color = lit ? accent_color() : IM_COL32(255, 255, 255, 230);
  if (lit) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
  if (held)
    compare.divider =
        std::clamp((ImGui::GetIO().MousePos.x - picture.x) / picture.width, 0.0f, 1.0f);
  ImGui::End();
  ImGui::PopStyleVar(2);

  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const float now = picture.x + compare.divider * picture.width;
  const float middle = picture.y + picture.height / 2, handle = 18 * theme.scale;
  draw.AddLine({now, picture.y}, {now, picture.bottom()}, IM_COL32(0, 0, 0, 120), 4 * theme.scale);
  draw.AddLine({now, picture.y}, {now, picture.bottom()}, color, 2 * theme.scale);
  draw.AddRectFilled({now - 4 * theme.scale, middle - handle},
                     {now + 4 * theme.scale, middle + handle}, color, 4 * theme.scale);
}

}  // namespace

void draw_comparison(const Rect& picture, const Theme& theme, ViewState& state, UiResult& result) {
  CompareSettings& compare = state.compare;
  if (compare.mode == CompareMode::kOff || !state.file) return;
  if (compare.mode == CompareMode::kWipe) draw_divider(picture, theme, compare, result);
  if (!state.frames.last || !state.frames.second) return;
  const FrameReport &first = *state.frames.last, &second = *state.frames.second;
  const float margin = 12 * theme.scale, top = picture.y + margin;
  const ImVec2 left{picture.x + margin, top};
  if (compare.mode == CompareMode::kDifference) {
    const PictureDifference& difference = *state.frames.difference;
    draw_plate(theme, left, Anchor::kLeft, difference_text(difference, first),
               difference_color(difference));
    return;
  }
  draw_plate(theme, left, Anchor::kLeft, title_of(first), technique_color(first.technique));
  const ImU32 second_dot = technique_color(second.technique);
  if (compare.mode == CompareMode::kWipe) {
    draw_plate(theme, {picture.right() - margin, top}, Anchor::kRight, title_of(second),
               second_dot);
    return;
  }
  const float middle = picture.x + picture.width / 2;
  draw_plate(theme, {middle + margin, top}, Anchor::kLeft, title_of(second), second_dot);
  ImGui::GetBackgroundDrawList()->AddLine({middle, picture.y}, {middle, picture.bottom()},
                                          IM_COL32(0, 0, 0, 140), 2 * theme.scale);
}

namespace {

/// How a line looks: a thin stroke on a dark one that sets it off, or alone.
struct Pen {
  ImU32 color;
  float width;
  ImU32 edge = 0;  ///< colour of the wider stroke below; 0: none
};

class LineDrawer {
 public:
  LineDrawer(const Projector& projector, const Theme& theme)
      : projector_(projector), theme_(theme), draw_(*ImGui::GetBackgroundDrawList()) {}

  void line(const Vec3d& from, const Vec3d& to, const Pen& pen) {
    const auto seen = projector_.project(from, to);
    if (!seen) return;
    const ImVec2 a{seen->from.x, seen->from.y}, b{seen->to.x, seen->to.y};
    if (pen.edge != 0) draw_.AddLine(a, b, pen.edge, (pen.width + 2) * theme_.scale);
    draw_.AddLine(a, b, pen.color, pen.width * theme_.scale);
  }

  /// The twelve edges of a box of a basis.
  void box(const Aabb& box, const Affine3d& world_from_local, const Pen& pen) {
    if (box.empty()) return;
    std::array<Vec3d, 8> corners;
    for (std::size_t i = 0; i < 8; ++i)
      corners[i] = world_from_local.point(
          {i & 1 ? box.hi.x : box.lo.x, i & 2 ? box.hi.y : box.lo.y, i & 4 ? box.hi.z : box.lo.z});
    for (std::size_t i = 0; i < 8; ++i)
      for (const std::size_t step : {1u, 2u, 4u})
        if ((i & step) == 0) line(corners[i], corners[i | step], pen);
  }

 private:
  const Projector& projector_;
  const Theme& theme_;
  ImDrawList& draw_;
};

/// The moment's bases and boxes, and how to draw in them.
struct Scene {
  const ModelView& model;
  const ClusterPlaces places;
  std::span<const FuzzyTree> trees;

  /// Empty where the map is singular.
  std::optional<Affine3d> world_from_local(std::uint32_t c) const {
    const Affine3d& map = places.local_from_world[c];
    const double determinant = map.determinant();
    if (!std::isfinite(determinant) || determinant == 0) return {};
    return inverse(map);
  }
};

constexpr ImU32 kEdge = IM_COL32(0, 0, 0, 130);

constexpr std::size_t kMaxTreeCells = 4000;

/// Cells of the tree at `depth` below the node, and leaves above it.
void collect_cells(const KdTreeView& tree, std::uint32_t node, const Aabb& cell, int depth,
                   std::vector<Aabb>& cells) {
  if (cells.size() >= kMaxTreeCells || tree.nodes.empty()) return;
  const KdNode& n = tree.nodes[node];
  if (n.is_leaf() || depth == 0) {
    if (!n.is_leaf() || n.ref_count() > 0) cells.push_back(cell);
    return;
  }
  Aabb below = cell, above = cell;
  below.hi[n.axis()] = above.lo[n.axis()] = n.split();
  collect_cells(tree, n.below(), below, depth - 1, cells);
  collect_cells(tree, n.above(), above, depth - 1, cells);
}

/// Of the cluster shown alone, else of the picked triangle's, else of all that are shown.
bool shows_cells(const ViewState& state, std::uint32_t c) {
  if (!state.clusters.shown(c)) return false;
  if (state.clusters.solo() || !state.picked) return true;
  return state.picked->cluster == c;
}

void draw_cluster(const Scene& scene, const ViewState& state, std::uint32_t c, LineDrawer& lines) {
  const OverlaySettings& overlays = state.overlays;
  const bool hovered = state.clusters.hovered == c;
  const ImU32 color = pack_srgb(cluster_color(c));
  const auto map = scene.world_from_local(c);
  if (overlays.tree_cells && shows_cells(state, c) && map) {
    std::vector<Aabb> cells;
    const KdTreeView tree = scene.model.tree_view(scene.trees[c]);
    collect_cells(tree, 0, tree.bounds, overlays.tree_depth, cells);
    const ImU32 faint = (color & ~IM_COL32_A_MASK) | (150u << IM_COL32_A_SHIFT);
    for (const Aabb& cell : cells) lines.box(cell, *map, {faint, 1.0f});
  }
  const bool shown = state.clusters.shown(c);
  if (((overlays.local_boxes && shown) || hovered) && map)
    lines.box(scene.trees[c].local_box, *map, {color, hovered ? 2.6f : 1.5f, kEdge});
  if (overlays.world_boxes && shown)
    lines.box(scene.places.world_boxes[c], Affine3d{}, {color, 1.5f, kEdge});
}

void draw_basis(const Aabb& local_box, const Affine3d& map, LineDrawer& lines) {
  constexpr std::array<ImU32, 3> kAxes = {IM_COL32(255, 90, 90, 255), IM_COL32(110, 230, 110, 255),
                                          IM_COL32(100, 150, 255, 255)};
  const Vec3d center = to_double(local_box.center());
  const Vec3d extent = to_double(local_box.extent());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3d tip = center;
    tip[axis] += extent[axis] / 2;
    lines.line(map.point(center), map.point(tip), {kAxes[axis], 2.4f, kEdge});
  }
}

void draw_pick(const Scene& scene, const ViewState& state, const Moment& moment,
               LineDrawer& lines) {
  const PickedTriangle& picked = *state.picked;
  const auto corners = corners_at(scene.model, moment, picked.triangle);
  const Pen outline{IM_COL32(255, 255, 255, 255), 2.0f, kEdge};
  for (std::size_t i = 0; i < 3; ++i) lines.line(corners[i], corners[(i + 1) % 3], outline);
  const auto map = scene.world_from_local(picked.cluster);
  if (!map) return;
  if (state.overlays.local_basis) draw_basis(scene.trees[picked.cluster].local_box, *map, lines);
  if (state.overlays.fuzzy_box) {
    const std::uint32_t segment = segment_of(scene.model, moment);
    lines.box(scene.model.fuzzy_box(segment, picked.cluster, picked.triangle), *map,
              {IM_COL32(255, 214, 92, 255), 1.8f, kEdge});
  }
}

}  // namespace

void draw_picture_lines(const Rect& picture, const Theme& theme, const ViewState& state) {
  if (!state.file || !state.frames.last) return;
  const OverlaySettings& o = state.overlays;
  const bool clusters =
      o.world_boxes || o.local_boxes || o.tree_cells || state.clusters.hovered.has_value();
  if (!clusters && !state.picked) return;
  const ModelView& model = *state.model();
  const FrameReport& frame = *state.frames.last;
  const Scene scene{model, cluster_places(model, frame.moment),
                    model.segment_trees(segment_of(model, frame.moment))};
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  for (const Rect& place : picture_places(picture, state.compare.mode)) {
    const Projector projector(frame.camera, place);
    LineDrawer lines(projector, theme);
    draw.PushClipRect({place.x, place.y}, {place.right(), place.bottom()});
    for (std::uint32_t c = 0; clusters && c < model.cluster_count(); ++c)
      draw_cluster(scene, state, c, lines);
    if (state.picked) draw_pick(scene, state, frame.moment, lines);
    draw.PopClipRect();
  }
}

}  // namespace mdk
