// What grows with what: time over triangles, memory over keys, and what baking costs.
#include <algorithm>
#include <cmath>
#include <map>

#include "preprocess/cli/bench/sections.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

using Family = std::vector<const ModelBench*>;

/// "hand" for "hand" and "hand-split2".
std::string family_name(const std::string& model) { return model.substr(0, model.find("-split")); }

/// Models that are one another subdivided, each family by rising triangles; only true families.
std::map<std::string, Family> families_of(const BenchRun& run) {
  std::map<std::string, Family> families;
  for (const ModelBench& model : run.models) families[family_name(model.name())].push_back(&model);
  std::erase_if(families, [](const auto& family) { return family.second.size() < 2; });
  for (auto& [name, family] : families)
    std::stable_sort(family.begin(), family.end(), [](const ModelBench* a, const ModelBench* b) {
      return a->triangles < b->triangles;
    });
  return families;
}

ChartSeries time_over_triangles(const Family& family, const std::string& id) {
  ChartSeries series{id, technique_style(id), {}};
  for (const ModelBench* model : family)
    if (const TechniqueBench* technique = model->find(id))
      series.points.push_back(
          {static_cast<double>(model->triangles), technique->time_to_image_ms().median});
  return series;
}

Chart crossover_chart(const std::string& name, const Family& family) {
  Chart chart;
  chart.title = name;
  chart.x_label = "triangles";
  chart.y_label = "time to image, ms";
  chart.x_scale = chart.y_scale = Scale::kLog;
  chart.marks = Marks::kDots;
  for (const TechniqueBench* technique : drawn_techniques(*family.front())) {
    ChartSeries series = time_over_triangles(family, technique->id);
    if (series.points.size() > 1) chart.series.push_back(std::move(series));
  }
  return chart;
}

/// Where one line crosses another, in triangles, taking both as straight in the log-log plot.
std::string crossing_text(const ChartSeries& fuzzy, const ChartSeries& other) {
  const std::size_t count = std::min(fuzzy.points.size(), other.points.size());
  std::vector<double> lead;  // above 0 where fuzzy is faster
  for (std::size_t i = 0; i < count; ++i)
    lead.push_back(std::log(other.points[i].y / fuzzy.points[i].y));
  const std::string against = "`" + other.label + "`";
  if (std::all_of(lead.begin(), lead.end(), [](double l) { return l > 0; }))
    return "is faster than " + against + " at every size measured";
  if (std::all_of(lead.begin(), lead.end(), [](double l) { return l <= 0; }))
    return "is slower than " + against + " at every size measured";
  std::string text;
  for (std::size_t i = 1; i < count; ++i) {
    if ((lead[i - 1] > 0) == (lead[i] > 0)) continue;
    const double from = std::log(fuzzy.points[i - 1].x), to = std::log(fuzzy.points[i].x);
    const double at = std::exp(from + (to - from) * lead[i - 1] / (lead[i - 1] - lead[i]));
    const double scale = std::pow(10.0, std::floor(std::log10(at)) - 1);
    text += (text.empty() ? "" : ", ") + std::string(lead[i] > 0 ? "overtakes " : "falls behind ") +
            against + " at about " +
            grouped_text(static_cast<std::uint64_t>(std::round(at / scale) * scale)) + " triangles";
  }
  return text;
}

Paragraph crossings(const std::string& name, const Family& family) {
  const ChartSeries fuzzy = time_over_triangles(family, "fuzzy-bvh");
  std::string text = name + ": `fuzzy-bvh` ";
  const char* separator = "";
  for (const char* id : {"refit-bvh", "rebuild-bvh", "embree"}) {
    const ChartSeries other = time_over_triangles(family, id);
    if (other.points.size() != family.size() || fuzzy.points.size() != family.size()) continue;
    text += separator + crossing_text(fuzzy, other);
    separator = "; ";
  }
  return {*separator == 0 ? name + ": `fuzzy-bvh` was not measured at every size." : text + "."};
}

/// Bytes after each key that was measured. Only the trees of `static-kdtree` go on adding up past
/// those: by their mean.
ChartSeries memory_over_keys(const TechniqueBench& technique, std::uint32_t keys) {
  constexpr double kMiB = 1 << 20;
  ChartSeries series{technique.id, technique_style(technique.id), {}};
  for (const BenchFrame& frame : technique.frames)
    series.points.push_back({static_cast<double>(series.points.size() + 1),
                             static_cast<double>(frame.structure_bytes) / kMiB});
  const ChartPoint last = series.points.back();
  const double per_key = technique.id == "static-kdtree" ? last.y / last.x : 0;
  for (double x = last.x; x < keys;) {
    x = std::min<double>(2 * x, keys);
    series.points.push_back({x, last.y + per_key * (x - last.x)});
  }
  return series;
}

Chart memory_chart(const ModelBench& model) {
  Chart chart;
  chart.title = model.name();
  chart.x_label = "keys made ready";
  chart.y_label = "MiB";
  chart.x_scale = chart.y_scale = Scale::kLog;
  for (const TechniqueBench* technique : drawn_techniques(model))
    chart.series.push_back(memory_over_keys(*technique, model.keys));
  return chart;
}

std::string percent_text(double share) { return fixed_text(share * 100, 3) + " %"; }

std::string stop_text(const std::string& reason) {
  if (reason == "cost") return "cost: another costs more than it saves";
  if (reason == "percent") return "percent: another gains too little";
  if (reason == "count") return "count: as many as asked for";
  if (reason == "bones") return "bones: one per bone";
  if (reason == "limit") return "limit: the most there may be";
  return reason;
}

std::vector<std::string> bake_row(const ModelBench& model) {
  const BakeFacts& bake = *model.bake;
  return {model.name(),
          stop_text(bake.stop_reason),
          grouped_text(model.triangles),
          std::to_string(model.keys),
          std::to_string(model.clusters),
          std::to_string(bake.segments),
          fixed_text(bake.read_s, 2),
          fixed_text(bake.decompose_s, 2),
          fixed_text(bake.build_s, 2),
          fixed_text(bake.write_s, 2),
          "**" + fixed_text(bake.total_s, 2) + "**",
          percent_text(bake.residual_rms),
          percent_text(bake.residual_max),
          fixed_text(bake.sah_cost, 1),
          bytes_text(bake.peak_memory_bytes),
          bytes_text(bake.file_bytes)};
}

}  // namespace

Section crossover_section(const BenchRun& run) {
  Section section{"crossover", "Where fuzzy structures overtake refitting and rebuilding", {}};
  Figure figure;
  figure.id = "crossover";
  figure.caption =
      "Median time to image over the number of triangles: one animation, its triangles split into "
      "four once, twice and so on. Both axes are logarithmic.";
  for (const auto& [name, family] : families_of(run)) {
    Chart chart = crossover_chart(name, family);
    if (chart.series.empty()) continue;
    section.blocks.push_back(crossings(name, family));
    figure.charts.push_back(std::move(chart));
  }
  if (figure.charts.empty()) {
    section.blocks.push_back(
        Paragraph{"Needs one animation at several sizes, named `NAME.mdk`, `NAME-split1.mdk`, "
                  "`NAME-split2.mdk` and so on."});
  } else {
    section.blocks.push_back(std::move(figure));
  }
  return section;
}

Section memory_section(const BenchRun& run) {
  Section section{"memory", "Memory over the number of keys", {}};
  Figure figure;
  figure.id = "memory";
  figure.caption =
      "Memory of the structures, the mesh aside, once trees for so many keys were made ready. Only "
      "`static-kdtree` needs one for each; past the keys measured its line goes on by their mean. "
      "Both axes are logarithmic. "
      "Maps and boxes of clusters at all keys count for the fuzzy techniques from the start.";
  for (const ModelBench* model : whole_models(run)) figure.charts.push_back(memory_chart(*model));
  if (figure.charts.empty())
    section.blocks.push_back(Paragraph{"Needs a model that is not a subdivided one."});
  else
    section.blocks.push_back(std::move(figure));
  return section;
}

Section bake_section(const BenchRun& run) {
  Section section{"bake", "What baking costs, and why it stopped", {}};
  Table table;
  table.head = {"model",   "stopped by",  "triangles",   "keys",    "clusters", "segments",
                "read s",  "decompose s", "build s",     "write s", "total s",  "residual rms",
                "largest", "cost",        "peak memory", "file"};
  table.left_columns = 2;
  for (const ModelBench& model : run.models)
    if (model.bake) table.rows.push_back(bake_row(model));
  if (table.rows.empty()) {
    section.blocks.push_back(
        Paragraph{"No bake reports stood beside the files: bake with `--report NAME.json` beside "
                  "`NAME.mdk`."});
    return section;
  }
  section.blocks.push_back(Paragraph{
      "From the bake's own reports: seconds of one run, residuals relative to the diagonal of the "
      "rest pose, cost as the expected work of a ray that meets the model."});
  section.blocks.push_back(std::move(table));
  return section;
}

}  // namespace mdk
