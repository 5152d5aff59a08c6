#include "viewer/panel/picture_lines.h"

#include <array>
#include <cmath>

#include "common/trace/color.h"
#include "common/trace/shading.h"
#include "viewer/state/projector.h"

namespace mdk {
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
  const Model& model;
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

ImU32 color_of(std::uint32_t cluster) { return pack_srgb(cluster_color(cluster)); }

constexpr ImU32 kEdge = IM_COL32(0, 0, 0, 130);

/// Cells of the tree at `depth` below the root, and leaves above it.
class CellWalk {
 public:
  CellWalk(const KdTreeView& tree, std::vector<Aabb>& cells) : tree_(tree), cells_(cells) {}

  void walk(std::uint32_t node, const Aabb& cell, int depth) {
    if (cells_.size() >= kMostTreeCells || tree_.nodes.empty()) return;
    const KdNode& n = tree_.nodes[node];
    if (n.is_leaf() || depth == 0) {
      if (!n.is_leaf() || n.ref_count() > 0) cells_.push_back(cell);
      return;
    }
    Aabb below = cell, above = cell;
    below.hi[n.axis()] = above.lo[n.axis()] = n.split();
    walk(n.below(), below, depth - 1);
    walk(n.above(), above, depth - 1);
  }

 private:
  const KdTreeView& tree_;
  std::vector<Aabb>& cells_;
};

/// Of the cluster shown alone, else of the picked triangle's, else of all that are shown.
bool shows_cells(const ViewState& state, std::uint32_t c) {
  if (!state.clusters.shown(c)) return false;
  if (state.clusters.solo() || !state.picked) return true;
  return state.picked->cluster == c;
}

void draw_cluster(const Scene& scene, const ViewState& state, std::uint32_t c, LineDrawer& lines) {
  const OverlaySettings& overlays = state.overlays;
  const bool hovered = state.clusters.hovered == c;
  const ImU32 color = color_of(c);
  const auto map = scene.world_from_local(c);
  if (overlays.tree_cells && shows_cells(state, c) && map) {
    std::vector<Aabb> cells;
    const KdTreeView tree = scene.model.tree_view(scene.trees[c]);
    CellWalk(tree, cells).walk(0, tree.bounds, overlays.tree_depth);
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
  if (!state.file || !state.last_frame) return;
  const OverlaySettings& o = state.overlays;
  const bool clusters =
      o.world_boxes || o.local_boxes || o.tree_cells || state.clusters.hovered.has_value();
  if (!clusters && !state.picked) return;
  const Model& model = *state.model();
  const FrameReport& frame = *state.last_frame;
  const Scene scene{model, cluster_places(model, frame.moment),
                    model.segment_trees(segment_of(model, frame.moment))};
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  for (const Rect& place : picture_places(picture, state.compare.mode)) {
    const Projector projector(frame.camera, place);
    LineDrawer lines(projector, theme);
    draw.PushClipRect({place.x, place.y}, {place.x + place.width, place.y + place.height});
    for (std::uint32_t c = 0; clusters && c < model.cluster_count(); ++c)
      draw_cluster(scene, state, c, lines);
    if (state.picked) draw_pick(scene, state, frame.moment, lines);
    draw.PopClipRect();
  }
}

}  // namespace mdk
