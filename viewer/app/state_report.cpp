#include "viewer/app/state_report.h"

#include <array>
#include <nlohmann/json.hpp>

#include "common/trace/technique.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

Json camera_json(const Camera& c) {
  return {c.eye.x,    c.eye.y, c.eye.z, c.target.x, c.target.y,
          c.target.z, c.up.x,  c.up.y,  c.up.z,     c.vertical_fov_deg};
}

Json frame_json(const ViewState& state) {
  if (!state.frames.last) return nullptr;
  const FrameReport& frame = *state.frames.last;
  Json json = {{"technique", technique_table()[frame.technique].id},
               {"width", frame.width},
               {"height", frame.height},
               {"pose_ms", frame.stats.pose_ms},
               {"update_ms", frame.stats.update_ms},
               {"trace_ms", frame.stats.trace_ms},
               {"shade_ms", frame.stats.shade_ms},
               {"time_to_image_ms", frame.stats.time_to_image_ms()},
               {"prebuild_ms", frame.stats.prebuild_ms},
               {"rays", frame.stats.rays},
               {"hits", frame.stats.hits},
               {"structure_bytes", frame.structure_bytes},
               {"note", frame.note}};
  const auto& work = state.frames.last_work;
  const bool counted = work && work->rays > 0 && work->technique == frame.technique;
  const auto per_ray = [&](std::uint64_t TraceCounters::*count) -> Json {
    if (!counted) return nullptr;
    return static_cast<double>(work->counters.*count) / static_cast<double>(work->rays);
  };
  json["node_visits_per_ray"] = per_ray(&TraceCounters::node_visits);
  json["triangle_tests_per_ray"] = per_ray(&TraceCounters::triangle_tests);
  json["clusters_per_ray"] = per_ray(&TraceCounters::clusters_entered);
  return json;
}

Json compare_json(const ViewState& state) {
  const CompareSettings& compare = state.compare;
  Json json = {{"mode", compare_mode_id(compare.mode)},
               {"against", technique_table()[compare.against].id},
               {"divider", compare.divider}};
  const bool known = state.frames.second && state.frames.difference;
  json["technique"] = known ? Json(technique_table()[state.frames.second->technique].id) : Json();
  json["time_to_image_ms"] = known ? Json(state.frames.second->stats.time_to_image_ms()) : Json();
  json["differing_pixels"] = known ? Json(state.frames.difference->pixels) : Json();
  json["largest_difference"] = known ? Json(state.frames.difference->largest) : Json();
  return json;
}

Json clusters_json(const ViewState& state) {
  if (!state.file) return nullptr;
  const ClusterView& clusters = state.clusters;
  const auto number = [](const std::optional<std::uint32_t>& c) { return c ? Json(*c) : Json(); };
  return {{"count", state.model()->cluster_count()},
          {"shown", clusters.shown_count()},
          {"solo", number(clusters.solo())},
          {"hovered", number(clusters.hovered)}};
}

Json picked_json(const ViewState& state) {
  if (!state.picked) return nullptr;
  const PickedTriangle& picked = *state.picked;
  const Moment moment = state.frames.last ? state.frames.last->moment : Moment{};
  const ModelView& model = *state.model();
  const Aabb box = model.fuzzy_box(segment_of(model, moment), picked.cluster, picked.triangle);
  return {{"triangle", picked.triangle},
          {"source_triangle", model.source_triangles[picked.triangle]},
          {"cluster", picked.cluster},
          {"depth", picked.depth},
          {"fuzzy_box", {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z}}};
}

Json overlays_json(const OverlaySettings& overlays) {
  return {{"world_boxes", overlays.world_boxes}, {"local_boxes", overlays.local_boxes},
          {"tree_cells", overlays.tree_cells},   {"tree_depth", overlays.tree_depth},
          {"fuzzy_box", overlays.fuzzy_box},     {"local_basis", overlays.local_basis}};
}

// By loop mode.
constexpr std::array kLoopIds = {"once", "loop", "ping-pong"};

Json cost_json(const CostCurves& costs) {
  Json json = Json::object();
  for (std::size_t t = 0; t < costs.technique_count(); ++t)
    if (costs.known(t) > 0)
      json[std::string(technique_table()[t].id)] = {{"moments", costs.moments().size()},
                                                    {"known", costs.known(t)},
                                                    {"longest_ms", costs.longest_ms(t)}};
  return json;
}

Json menu_json(const ViewState& state) {
  if (!state.file_menu) return nullptr;
  Json labels = Json::array();
  for (const FileChoice& choice : state.file_menu->choices) labels.push_back(choice.label);
  return labels;
}

Json hand_json(const ViewState& state) {
  if (!state.hand.active) return nullptr;
  const SkeletonView& skeleton = state.model()->skeleton;
  const Vec3d& turn = state.hand.pose.turns[state.hand.joint];
  const std::uint32_t past = joint_past_limit(skeleton, state.hand.pose);
  return {{"joint", joint_name(skeleton, state.hand.joint)},
          {"turn_radians", {turn.x, turn.y, turn.z}},
          {"past_limit", past == kNoParent ? Json() : Json(joint_name(skeleton, past))}};
}

}  // namespace

std::string state_json(const ViewState& state, const WindowReport& window) {
  const Playback& playback = state.playback;
  Json json = {{"schema", "mdview-state/1"}};
  json["file"] = state.file ? Json(state.path) : Json();
  json["exporting"] = state.exporting ? Json(state.exporting->fraction) : Json();
  json["recent_files"] = Json::array();
  for (const FileChoice& choice : state.recent_files)
    json["recent_files"].push_back(choice.paths.front());
  json["file_menu"] = menu_json(state);
  json["baking"] = state.baking ? Json(state.baking->name) : Json();
  json["technique"] = technique_table()[state.settings.technique].id;
  json["shading"] = shading_id(state.settings.shading);
  json["clip"] = playback.clips().empty() ? Json() : Json(playback.clips()[playback.clip()].name);
  json["time"] = playback.time();
  json["key"] = playback.key();
  json["playing"] = playback.playing();
  json["loop"] = kLoopIds[static_cast<std::size_t>(playback.loop())];
  json["speed"] = playback.speed();
  const auto& range = playback.range();
  json["range"] = range ? Json{range->begin, range->end} : Json();
  json["cost_curves"] = cost_json(state.cost_curves);
  json["resolution"] = kResolutionNames[static_cast<std::size_t>(state.settings.resolution)];
  json["theme"] = state.settings.colors == ColorScheme::kDark ? "dark" : "light";
  json["text_percent"] = state.settings.text_percent;
  json["turntable"] = state.turntable;
  json["counting"] = state.settings.count_work;
  json["cost_columns"] = state.settings.cost_columns == CostColumns::kTimes ? "times" : "work";
  json["camera"] = camera_json(state.camera.camera());
  json["pose_by_hand"] = hand_json(state);
  json["compare"] = compare_json(state);
  json["clusters"] = clusters_json(state);
  json["picked"] = picked_json(state);
  json["overlays"] = overlays_json(state.overlays);
  json["frames_shown"] = window.frames_shown;
  json["window_draws"] = window.window_draws;
  json["first_picture_ms"] = window.first_picture_ms > 0 ? Json(window.first_picture_ms) : Json();
  json["open_ms"] = window.open_ms > 0 ? Json(window.open_ms) : Json();
  const auto median = state.frames.history.median_ms(state.settings.technique);
  json["median_time_to_image_ms"] = median ? Json(*median) : Json();
  json["last_frame"] = frame_json(state);
  json["help"] = state.help_open;
  json["panel"] = state.panel == PanelMode::kShown;
  json["tab"] = panel_tab_id(state.tab);
  json["error"] = state.error.empty() ? Json() : Json(state.error);
  json["notice"] = state.notice.empty() ? Json() : Json(state.notice);
  json["render_command"] = window.render_command.empty() ? Json() : Json(window.render_command);
  json["window"] = {window.width, window.height};
  Json& widgets = json["widgets"] = Json::object();
  for (const auto& [name, r] : window.widgets) widgets[name] = {r.x, r.y, r.width, r.height};
  // Names in a file may be any bytes; what is not UTF-8 must not end the program here.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace mdk
