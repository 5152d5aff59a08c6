// Table I and Figures 5.1 to 5.20 of Lo09, with our figures in place of theirs.
#include <algorithm>
#include <functional>

#include "preprocess/cli/bench/sections.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

constexpr const char* kTechniques[] = {"rebuild-bvh", "refit-bvh", "fuzzy-bvh", "decomp-refit"};

/// Lo09 Table I, frames per second in the order of kTechniques.
struct ThesisRow {
  const char* animation;
  double fps[4];
};
constexpr ThesisRow kThesis[] = {{"Cally walking", {11.55, 12.44, 8.76, 9.50}},
                                 {"Cally freestyle", {11.21, 11.37, 8.78, 9.22}},
                                 {"Skeleton freestyle", {13.07, 14.36, 13.81, 13.50}},
                                 {"Paladin jogging", {9.86, 10.35, 6.97, 7.72}}};

std::vector<std::string> table1_row(const std::string& name, const double (&fps)[4]) {
  std::vector<std::string> cells = {name};
  for (const double value : fps) cells.push_back(fixed_text(value, 2));
  for (std::size_t i = 1; i < 4; ++i)
    cells.push_back(fps[0] > 0 ? "**" + fixed_text(fps[i] / fps[0], 2) + "**" : "–");
  return cells;
}

/// A figure of the thesis: what its lines show.
struct FrameFigure {
  const char* id;
  const char* numbers;
  const char* title;
  const char* y_label;
  const char* caption;
  Scale scale;
  std::function<double(const TechniqueBench&, const BenchFrame&)> value;
};

double per_ray(std::uint64_t count, const TechniqueBench& technique) {
  return technique.rays_per_frame > 0
             ? static_cast<double>(count) / static_cast<double>(technique.rays_per_frame)
             : 0;
}

std::vector<FrameFigure> frame_figures() {
  return {
      {"lo09-time-to-image", "5.1–5.4", "Time to image", "ms", "Pose, update, trace and shade.",
       Scale::kLinear,
       [](const TechniqueBench&, const BenchFrame& f) { return f.time_to_image_ms(); }},
      {"lo09-trace", "5.5–5.8", "Trace time", "ms", "Finding the closest hits of all rays.",
       Scale::kLinear, [](const TechniqueBench&, const BenchFrame& f) { return f.trace_ms; }},
      {"lo09-triangle-tests", "5.9–5.12", "Triangle tests", "tests per ray",
       "Ray-triangle pairs evaluated, over all rays of the picture. Peers do not count.",
       Scale::kLinear,
       [](const TechniqueBench& t, const BenchFrame& f) {
         return per_ray(f.counters.triangle_tests, t);
       }},
      {"lo09-node-tests", "5.13–5.16", "Node tests", "visits per ray",
       "Boxes tested or kd-tree nodes visited, once for a tile of rays that shares a frustum. "
       "Peers "
       "do not count.",
       Scale::kLinear,
       [](const TechniqueBench& t, const BenchFrame& f) {
         return per_ray(f.counters.node_visits, t);
       }},
      {"lo09-update", "5.17–5.20", "Update time", "ms",
       "Making the structure valid for the frame, on a logarithmic scale; the pose is computed "
       "before, alike for all. `static-kdtree` only swaps trees that were built ahead.",
       Scale::kLog, [](const TechniqueBench&, const BenchFrame& f) { return f.update_ms; }},
  };
}

Chart frame_chart(const ModelBench& model, const FrameFigure& kind) {
  Chart chart;
  chart.title = model.name();
  chart.x_label = "key";
  chart.y_label = kind.y_label;
  chart.y_scale = kind.scale;
  for (const TechniqueBench* technique : drawn_techniques(model)) {
    ChartSeries series{technique->id, technique_style(technique->id), {}};
    double largest = 0;
    for (const BenchFrame& frame : technique->frames) {
      const double value = kind.value(*technique, frame);
      largest = std::max(largest, value);
      series.points.push_back({static_cast<double>(frame.key), value});
    }
    if (largest > 0) chart.series.push_back(std::move(series));
  }
  return chart;
}

Section figure_section(const BenchRun& run, const FrameFigure& kind) {
  Section section{
      kind.id,
      std::string(kind.title) + " over the animation (Lo09 Figures " + kind.numbers + ")",
      {}};
  Figure figure;
  figure.id = kind.id;
  figure.caption = kind.caption;
  for (const ModelBench* model : whole_models(run)) {
    if (model->techniques.front().frames.size() < 2) continue;
    Chart chart = frame_chart(*model, kind);
    if (!chart.series.empty()) figure.charts.push_back(std::move(chart));
  }
  if (figure.charts.empty()) {
    section.blocks.push_back(Paragraph{"Needs a model measured at two keys or more."});
  } else {
    section.blocks.push_back(std::move(figure));
  }
  return section;
}

}  // namespace

Section lo09_table1_section(const BenchRun& run) {
  Section section{"lo09-table-1", "Four techniques for moving meshes (Lo09 Table I)", {}};
  Table ours, theirs;
  ours.head = theirs.head = {
      "animation",          "fast rebuilds",   "refitting",       "clusters, fuzzy",
      "clusters, refitted", "refit / rebuild", "fuzzy / rebuild", "clusters, refitted / rebuild"};
  for (const ModelBench& model : run.models) {
    double fps[4] = {};
    bool complete = true;
    for (std::size_t i = 0; i < 4; ++i) {
      const TechniqueBench* technique = model.find(kTechniques[i]);
      complete = complete && technique != nullptr;
      const double ms = technique != nullptr ? technique->time_to_image_ms().median : 0;
      fps[i] = ms > 0 ? 1000 / ms : 0;
    }
    if (complete) ours.rows.push_back(table1_row(model.name(), fps));
  }
  for (const ThesisRow& row : kThesis) theirs.rows.push_back(table1_row(row.animation, row.fps));
  section.blocks.push_back(Paragraph{
      "Frames per second (1000 / median time to image) of `rebuild-bvh`, `refit-bvh`, "
      "`fuzzy-bvh` and `decomp-refit`, and how many times as fast as rebuilding each is."});
  if (ours.rows.empty()) {
    section.blocks.push_back(Paragraph{"Needs all four measured on one model."});
  } else {
    section.blocks.push_back(std::move(ours));
  }
  section.blocks.push_back(Paragraph{
      "The thesis's own figures (512 x 512, one core at 2.4 GHz, 2009; first 50 frames):"});
  section.blocks.push_back(std::move(theirs));
  return section;
}

std::vector<Section> lo09_figure_sections(const BenchRun& run) {
  std::vector<Section> sections;
  for (const FrameFigure& kind : frame_figures()) sections.push_back(figure_section(run, kind));
  return sections;
}

}  // namespace mdk
