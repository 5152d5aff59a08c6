// Tables and figures of Lo09, with our figures in place of the thesis's.
#include <algorithm>
#include <array>

#include "common/base/text.h"
#include "preprocess/bench/report.h"

namespace mdk {
namespace {

/// A row of Lo09 Table I: frames per second in the order of kFour.
struct FourRates {
  std::string animation;
  std::array<double, 4> fps{};
};
constexpr const char* kFour[] = {"rebuild-bvh", "refit-bvh", "fuzzy-bvh", "decomp-refit"};
const std::vector<FourRates>& thesis_rows() {
  static const std::vector<FourRates> rows = {{"Cally walking", {11.55, 12.44, 8.76, 9.50}},
                                              {"Cally freestyle", {11.21, 11.37, 8.78, 9.22}},
                                              {"Skeleton freestyle", {13.07, 14.36, 13.81, 13.50}},
                                              {"Paladin jogging", {9.86, 10.35, 6.97, 7.72}}};
  return rows;
}

Table four_table(std::string text, const std::vector<FourRates>& rows) {
  std::vector<Column<FourRates>> columns = {{"animation", [](auto& r) { return r.animation; }}};
  std::size_t t = 0;
  for (const char* head : {"fast rebuilds", "refitting", "clusters, fuzzy", "clusters, refitted"})
    columns.push_back({head, [i = t++](auto& r) { return fixed_text(r.fps[i], 2); }});
  t = 1;
  for (const char* head : {"refit / rebuild", "fuzzy / rebuild", "clusters, refitted / rebuild"})
    columns.push_back({head, [i = t++](auto& r) {
                         return r.fps[0] > 0 ? strong_ratio(r.fps[i], r.fps[0]) : "–";
                       }});
  return table_of(std::move(text), rows, columns);
}

Section lo09_table1(const BenchRun& run) {
  std::vector<FourRates> ours;
  for (const ModelBench& model : run.models) {
    if (const std::string variant = variant_of(model.name());
        !variant.empty() && variant != "bones")
      continue;
    FourRates row{model.name()};
    std::size_t found = 0;
    for (const char* id : kFour)
      if (const TechniqueBench* technique = model.find(id)) row.fps[found++] = technique->fps();
    if (found == row.fps.size()) ours.push_back(row);
  }
  return {"lo09-table-1",
          "Four techniques for moving meshes (Lo09 Table I)",
          {Paragraph{"Frames per second (1000 / median time to image) of `rebuild-bvh`, "
                     "`refit-bvh`, `fuzzy-bvh` and `decomp-refit`, and how many times as fast as "
                     "rebuilding each is. Clusters are those of the default decomposition, and, "
                     "in models named `-bones`, one for each bone, as the thesis has them."},
           or_needs(four_table("", ours), "Needs all four measured on one model."),
           four_table("The thesis's own figures (512 x 512, one core at 2.4 GHz, 2009; first 50 "
                      "frames):",
                      thesis_rows())}};
}

/// Lo09 Table 4.2: boxes and triangles tested per hit by a refitted hierarchy.
struct RefitTests {
  std::string animation;
  double boxes_first = 0, triangles_first = 0, boxes_rest = 0, triangles_rest = 0;
};
const std::vector<RefitTests>& thesis_refit_rows() {
  static const std::vector<RefitTests> rows = {{"Cally walking", 95.92, 7.6, 77.12, 6.53},
                                               {"Cally jogging", 89.6, 7.2, 75.67, 6.9},
                                               {"Cally freestyle", 93.54, 9.78, 78.45, 8.27},
                                               {"Skeleton walking", 137.81, 11.93, 125.72, 11.97},
                                               {"Skeleton jogging", 127.91, 11.86, 121.25, 12.16},
                                               {"Skeleton freestyle", 161.15, 11.63, 143.11, 12.3},
                                               {"Paladin walking", 78.23, 7.29, 62.44, 6.91},
                                               {"Paladin jogging", 77.06, 8.31, 65.9, 7.71},
                                               {"Paladin freestyle", 66.56, 7.61, 69.74, 10.1}};
  return rows;
}

Table refit_table(std::string text, const std::vector<RefitTests>& rows, int digits) {
  const auto figure = [digits](double RefitTests::*part) {
    return [=](const RefitTests& row) { return fixed_text(row.*part, digits); };
  };
  return table_of<RefitTests>(
      std::move(text), rows,
      {{"animation", [](auto& r) { return r.animation; }},
       {"boxes/hit, first frame", figure(&RefitTests::boxes_first)},
       {"triangles/hit, first frame", figure(&RefitTests::triangles_first)},
       {"boxes/hit, rest pose", figure(&RefitTests::boxes_rest)},
       {"triangles/hit, rest pose", figure(&RefitTests::triangles_rest)},
       {"boxes, rest / first", [](auto& r) { return strong_ratio(r.boxes_rest, r.boxes_first); }},
       {"triangles, rest / first",
        [](auto& r) { return strong_ratio(r.triangles_rest, r.triangles_first); }}});
}

Section lo09_table4_2(const BenchRun& run) {
  std::vector<RefitTests> ours;
  for (const ModelBench& model : run.models) {
    const ModelBench* first = run.find(model.name() + "-first");
    if (first == nullptr) continue;
    const TechniqueBench *on_rest = model.find("refit-bvh"), *on_first = first->find("refit-bvh");
    if (on_rest == nullptr || on_first == nullptr) continue;
    const WorkPerRay rest = on_rest->work_per_hit(), at_first = on_first->work_per_hit();
    if (rest.node_visits > 0 && at_first.node_visits > 0)
      ours.push_back({model.name(), at_first.node_visits, at_first.triangle_tests, rest.node_visits,
                      rest.triangle_tests});
  }
  return {"lo09-table-4-2",
          "A hierarchy over the first frame or over the rest pose (Lo09 Table 4.2)",
          {or_needs(refit_table("Boxes tested and triangles tested after culling by `refit-bvh`, "
                                "divided by the rays that hit. A tile shares the boxes it tests, "
                                "so they are few beside the thesis's, which traced single rays. "
                                "The rest pose is the key that explains all others best.",
                                ours, 3),
                    "Needs `refit-bvh` measured on a model and on its bake with `--rest-pose 0`, "
                    "named `NAME-first`."),
           refit_table("The thesis's own figures:", thesis_refit_rows(), 2)}};
}

/// Lo09 Table 4.4: frames per second of motion decomposition with fuzzy boxes, by sampling.
struct SamplingRates {
  std::string animation;
  double pose_space = 0, cycle = 0;
};
const std::vector<SamplingRates>& thesis_sampling_rows() {
  static const std::vector<SamplingRates> rows = {{"Cally walking", 8.28, 8.76},
                                                  {"Cally freestyle", 8.76, 8.78},
                                                  {"Skeleton freestyle", 13.77, 13.81},
                                                  {"Paladin jogging", 6.11, 6.97}};
  return rows;
}

Table sampling_table(std::string text, const std::vector<SamplingRates>& rows) {
  return table_of<SamplingRates>(
      std::move(text), rows,
      {{"animation", [](auto& r) { return r.animation; }},
       {"pose space", [](auto& r) { return fixed_text(r.pose_space, 2); }},
       {"animation cycle", [](auto& r) { return fixed_text(r.cycle, 2); }},
       {"cycle / pose space", [](auto& r) { return strong_ratio(r.cycle, r.pose_space); }}});
}

Section lo09_table4_4(const BenchRun& run) {
  std::vector<SamplingRates> ours;
  for (const ModelBench& model : run.models) {
    if (variant_of(model.name()) != "bones") continue;
    const std::string name = base_name(model.name());
    const ModelBench* space = run.find(name + "-space");
    const TechniqueBench* cycle = model.find("fuzzy-bvh");
    const TechniqueBench* posed = space != nullptr ? space->find("fuzzy-bvh") : nullptr;
    if (cycle != nullptr && posed != nullptr) ours.push_back({name, posed->fps(), cycle->fps()});
  }
  return {"lo09-table-4-4",
          "Boxes for the clip's poses or for a whole pose space (Lo09 Table 4.4)",
          {or_needs(sampling_table(
                        "Frames per second of `fuzzy-bvh`, one cluster for each bone. Animation "
                        "cycle: boxes hold for the clip. Pose space: they hold for every pose in "
                        "which no joint is turned past 90 degrees, bounded in closed form where "
                        "the thesis sampled it.",
                        ours),
                    "Needs `fuzzy-bvh` measured on bakes with `--decompose bones`, named "
                    "`NAME-bones`, and with `--sampling pose-space`, named `NAME-space`."),
           sampling_table("The thesis's own figures:", thesis_sampling_rows())}};
}

/// Figures 5.1 to 5.20 of Lo09: a chart for each model, a line for each technique over the keys.
struct FrameFigure {
  const char* id;
  const char* numbers;
  const char* title;
  const char* y_label;
  const char* caption;
  Scale scale;
  double (*value)(const BenchFrame&);
  bool is_per_ray = false;
};
const FrameFigure kFrameFigures[] = {
    {"lo09-time-to-image", "5.1–5.4", "Time to image", "ms", "Pose, update, trace and shade.",
     Scale::kLinear, [](const BenchFrame& f) { return f.time_to_image_ms(); }},
    {"lo09-trace", "5.5–5.8", "Trace time", "ms", "Finding the closest hits of all rays.",
     Scale::kLinear, [](const BenchFrame& f) { return f.trace_ms; }},
    {"lo09-triangle-tests", "5.9–5.12", "Triangle tests", "tests per ray",
     "Ray-triangle pairs evaluated after culling, over all rays of the picture. Peers do not "
     "count.",
     Scale::kLinear,
     [](const BenchFrame& f) { return static_cast<double>(f.counters.triangle_tests); }, true},
    {"lo09-node-tests", "5.13–5.16", "Node tests", "visits per ray",
     "Boxes tested or kd-tree nodes visited, once for a tile of rays that shares a frustum. Peers "
     "do not count.",
     Scale::kLinear,
     [](const BenchFrame& f) { return static_cast<double>(f.counters.node_visits); }, true},
    {"lo09-update", "5.17–5.20", "Update time", "ms",
     "Making the structure valid for the frame, on a logarithmic scale; the pose is computed "
     "before, alike for all. `static-kdtree` only swaps trees that were built ahead.",
     Scale::kLog, [](const BenchFrame& f) { return f.update_ms; }},
};

std::vector<ChartPoint> frame_points(const TechniqueBench& technique, const FrameFigure& kind) {
  std::vector<ChartPoint> points;
  const double unit = kind.is_per_ray ? static_cast<double>(technique.rays_per_frame) : 1;
  double largest = 0;
  for (const BenchFrame& frame : technique.frames) {
    const double value = unit > 0 ? kind.value(frame) / unit : 0;
    largest = std::max(largest, value);
    points.push_back({static_cast<double>(frame.key), value});
  }
  return technique.frames.size() > 1 && largest > 0 ? points : std::vector<ChartPoint>();
}

Section lo09_figure(const BenchRun& run, const FrameFigure& kind) {
  const auto chart_of = [&](const ModelBench& model) {
    return Chart{.title = model.name(),
                 .x_label = "key",
                 .y_label = kind.y_label,
                 .y_scale = kind.scale,
                 .series = technique_series(model, [&](const TechniqueBench& technique) {
                   return frame_points(technique, kind);
                 })};
  };
  return figure_section(
      {.id = kind.id, .caption = kind.caption, .charts = charts_of_models(run, chart_of)},
      std::string(kind.title) + " over the animation (Lo09 Figures " + kind.numbers + ")",
      "Needs a model measured at two keys or more.");
}

}  // namespace

std::vector<Section> lo09_sections(const BenchRun& run) {
  std::vector<Section> sections = {lo09_table1(run), lo09_table4_2(run), lo09_table4_4(run)};
  for (const FrameFigure& kind : kFrameFigures) sections.push_back(lo09_figure(run, kind));
  return sections;
}

}  // namespace mdk
