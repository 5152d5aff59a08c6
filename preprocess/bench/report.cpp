// The report but for what stands beside the papers (papers.cpp): the figures that matter most,
// what grows with what, and every figure that was measured.
#include "preprocess/bench/report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/base/text.h"

namespace mdk {
namespace {

using Technique = const TechniqueBench*;  // null where it was not measured

// --- texts of cells ---

std::string ms_text(Technique technique) {
  return technique == nullptr ? "–" : fixed_text(technique->time_to_image_ms().median, 2);
}

std::string ms_and_id(Technique technique) {
  return technique == nullptr ? "–" : ms_text(technique) + " `" + technique->id + "`";
}

/// How many times as fast `technique` is as `other`.
std::string speed_text(Technique technique, Technique other) {
  if (technique == nullptr || other == nullptr) return "–";
  return "**" + ratio_text(other->time_to_image_ms().median, technique->time_to_image_ms().median) +
         "**";
}

std::string percent_text(double share) { return fixed_text(share * 100, 3) + " %"; }

// --- the figures that matter most ---

/// The one with the least median time to image among those with these ids.
Technique fastest_of(const ModelBench& model, std::initializer_list<const char*> ids) {
  Technique best = nullptr;
  for (const char* id : ids) {
    Technique technique = model.find(id);
    if (technique == nullptr) continue;
    if (best == nullptr || technique->time_to_image_ms().median < best->time_to_image_ms().median)
      best = technique;
  }
  return best;
}

/// A model in a run, and the fastest of each kind there.
struct Contest {
  const BenchRun& run;
  const ModelBench& model;
  Technique fuzzy = fastest_of(model, {"fuzzy-bvh", "fuzzy-kdtree"});
  Technique embree = fastest_of(model, {"embree", "embree-refit", "embree-low", "embree-medium"});
  Technique other = fastest_of(model, {"rebuild-bvh", "refit-bvh", "tsah-refit", "hybrid-bvh",
                                       "rotate-bvh", "decomp-refit"});
  Technique fuzzy_bvh = model.find("fuzzy-bvh");
  Technique rebuilt = model.find("rebuild-bvh");
};

std::string mismatch_sentence(const BenchResults& results) {
  std::uint64_t ours = 0, peers = 0, pixels = 0;
  for (const BenchRun& run : results.runs)
    for (const ModelBench& model : run.models)
      for (const TechniqueBench& technique : model.techniques) {
        const bool is_peer = technique.id.starts_with("embree");
        (is_peer ? peers : ours) += technique.hit_mismatches;
        pixels += technique.rays_per_frame * technique.judged_frames;
      }
  return "Of " + grouped_text(pixels) + " pixels judged by brute force, " + grouped_text(ours) +
         " differ in a technique of ours (bit by bit), " + grouped_text(peers) +
         " in Embree (another triangle, and a depth that differs by more than 1e-5).";
}

Section summary(const BenchResults& results) {
  std::vector<Contest> rows;
  for (const ModelBench& model : results.runs.front().models)
    if (variant_of(model.name()).empty()) rows.push_back({results.runs.front(), model});
  return {
      "summary",
      "At a glance",
      {table_of<Contest>(
           "Median time to image in milliseconds (pose + update + trace + shade) of the faster "
           "fuzzy structure, of Embree in its fastest mode and of the fastest structure that is "
           "refitted or rebuilt; how many times as fast the fuzzy one is; trace time of "
           "`fuzzy-bvh` over that of a hierarchy built for the very key (`rebuild-bvh`); its "
           "update in milliseconds.",
           rows,
           {{"model", [](auto& r) { return r.model.name(); }},
            {"triangles", [](auto& r) { return grouped_text(r.model.triangles); }},
            {"clusters", [](auto& r) { return std::to_string(r.model.clusters); }},
            {"fuzzy ms", [](auto& r) { return ms_and_id(r.fuzzy); }},
            {"Embree ms", [](auto& r) { return ms_and_id(r.embree); }},
            {"times as fast", [](auto& r) { return speed_text(r.fuzzy, r.embree); }},
            {"refit or rebuilt ms", [](auto& r) { return ms_and_id(r.other); }},
            {"times as fast", [](auto& r) { return speed_text(r.fuzzy, r.other); }},
            {"trace / rebuilt's",
             [](auto& r) {
               if (r.fuzzy_bvh == nullptr || r.rebuilt == nullptr) return std::string("–");
               return ratio_text(r.fuzzy_bvh->median_ms(&BenchFrame::trace_ms),
                                 r.rebuilt->median_ms(&BenchFrame::trace_ms));
             }},
            {"update ms",
             [](auto& r) {
               if (r.fuzzy_bvh == nullptr) return std::string("–");
               return fixed_text(r.fuzzy_bvh->median_ms(&BenchFrame::update_ms), 3);
             }}}),
       Paragraph{mismatch_sentence(results)}}};
}

/// A technique that was measured with one thread and with more.
struct ThreadPair {
  const BenchSetting& setting;
  std::string model;
  Technique one, more;
};

std::vector<ThreadPair> thread_pairs(const BenchResults& results) {
  std::vector<ThreadPair> pairs;
  for (const BenchRun& run : results.runs) {
    BenchSetting one_thread = run.setting;
    one_thread.threads = 1;
    const auto single =
        std::find_if(results.runs.begin(), results.runs.end(),
                     [&](const BenchRun& other) { return other.setting == one_thread; });
    if (run.setting.threads <= 1 || single == results.runs.end()) continue;
    for (const ModelBench& model : run.models)
      if (const ModelBench* same = single->find(model.name()))
        for (const TechniqueBench& technique : model.techniques)
          if (Technique one = same->find(technique.id))
            pairs.push_back({run.setting, model.name(), one, &technique});
  }
  return pairs;
}

Section machines(const BenchResults& results) {
  std::vector<Contest> rows;
  for (const ModelBench& model : results.runs.front().models)
    for (const BenchRun& run : results.runs)
      if (const ModelBench* same = run.find(model.name()); same && variant_of(same->name()).empty())
        rows.push_back({run, *same});
  Section section{
      "machines",
      "Instruction sets and threads",
      {table_of<Contest>(
          "Median time to image in milliseconds of the faster fuzzy structure and of Embree in its "
          "fastest mode, both held to the same instruction set and threads. Lit pictures have a "
          "shadow ray and 16 rays of ambient occlusion for every pixel that hits.",
          rows,
          {{"model", [](auto& r) { return r.model.name(); }},
           {"instruction set", [](auto& r) { return r.run.setting.isa; }},
           {"threads", [](auto& r) { return std::to_string(r.run.setting.threads); }},
           {"shading", [](auto& r) { return r.run.setting.shading; }},
           {"triangles", [](auto& r) { return grouped_text(r.model.triangles); }},
           {"fuzzy ms", [](auto& r) { return ms_and_id(r.fuzzy); }},
           {"Embree ms", [](auto& r) { return ms_and_id(r.embree); }},
           {"times as fast", [](auto& r) { return speed_text(r.fuzzy, r.embree); }}},
          2)}};
  const std::vector<ThreadPair> pairs = thread_pairs(results);
  if (!pairs.empty())
    section.blocks.push_back(table_of<ThreadPair>(
        "More threads beside one:", pairs,
        {{"model", [](auto& r) { return r.model; }},
         {"technique", [](auto& r) { return "`" + r.more->id + "`"; }},
         {"instruction set", [](auto& r) { return r.setting.isa; }},
         {"threads", [](auto& r) { return std::to_string(r.setting.threads); }},
         {"1 thread ms", [](auto& r) { return ms_text(r.one); }},
         {"ms", [](auto& r) { return ms_text(r.more); }},
         {"times as fast", [](auto& r) { return speed_text(r.more, r.one); }}},
        3));
  return section;
}

// --- what grows with what ---

using Family = std::vector<const ModelBench*>;

/// Models that are one another subdivided ("hand", "hand-split2"), each family by rising triangles.
std::map<std::string, Family> families_of(const BenchRun& run) {
  std::map<std::string, Family> families;
  for (const ModelBench& model : run.models) {
    const std::string name = model.name();
    families[name.substr(0, name.find("-split"))].push_back(&model);
  }
  std::erase_if(families, [](const auto& family) { return family.second.size() < 2; });
  for (auto& [name, family] : families)
    std::stable_sort(family.begin(), family.end(), [](const ModelBench* a, const ModelBench* b) {
      return a->triangles < b->triangles;
    });
  return families;
}

std::vector<ChartPoint> time_over_triangles(const Family& family, const std::string& id) {
  std::vector<ChartPoint> points;
  for (const ModelBench* model : family)
    if (Technique technique = model->find(id))
      points.push_back(
          {static_cast<double>(model->triangles), technique->time_to_image_ms().median});
  return points;
}

/// Where one line crosses another, in triangles, taking both as straight in the log-log plot.
std::string crossing_text(const std::vector<ChartPoint>& fuzzy,
                          const std::vector<ChartPoint>& other, const std::string& against) {
  std::vector<double> lead;  // above 0 where fuzzy is faster
  for (std::size_t i = 0; i < fuzzy.size(); ++i) lead.push_back(std::log(other[i].y / fuzzy[i].y));
  if (std::all_of(lead.begin(), lead.end(), [](double l) { return l > 0; }))
    return "is faster than " + against + " at every size measured";
  if (std::all_of(lead.begin(), lead.end(), [](double l) { return l <= 0; }))
    return "is slower than " + against + " at every size measured";
  std::string text;
  for (std::size_t i = 1; i < lead.size(); ++i) {
    if ((lead[i - 1] > 0) == (lead[i] > 0)) continue;
    const double from = std::log(fuzzy[i - 1].x), to = std::log(fuzzy[i].x);
    const double at = std::exp(from + (to - from) * lead[i - 1] / (lead[i - 1] - lead[i]));
    const double scale = std::pow(10.0, std::floor(std::log10(at)) - 1);
    text += (text.empty() ? "" : ", ") + std::string(lead[i] > 0 ? "overtakes " : "falls behind ") +
            against + " at about " +
            grouped_text(static_cast<std::uint64_t>(std::round(at / scale) * scale)) + " triangles";
  }
  return text;
}

Paragraph crossings(const std::string& name, const Family& family) {
  const std::vector<ChartPoint> fuzzy = time_over_triangles(family, "fuzzy-bvh");
  std::string text;
  for (const std::string id : {"refit-bvh", "rebuild-bvh", "embree"}) {
    const std::vector<ChartPoint> other = time_over_triangles(family, id);
    if (other.size() == family.size() && fuzzy.size() == family.size())
      text += (text.empty() ? "" : "; ") + crossing_text(fuzzy, other, "`" + id + "`");
  }
  return {name + ": `fuzzy-bvh` " + (text.empty() ? "was not measured at every size" : text) + "."};
}

Section crossover(const BenchRun& run) {
  std::vector<Block> texts;
  Figure figure{.id = "crossover",
                .caption =
                    "Median time to image over the number of triangles: one animation, its "
                    "triangles split into four once, twice and so on. Both axes are logarithmic."};
  for (const auto& [name, family] : families_of(run)) {
    Chart chart{.title = name,
                .x_label = "triangles",
                .y_label = "time to image, ms",
                .x_scale = Scale::kLog,
                .y_scale = Scale::kLog,
                .marks = Marks::kDots,
                .series = technique_series(*family.front(), [&](const TechniqueBench& technique) {
                  auto points = time_over_triangles(family, technique.id);
                  return points.size() > 1 ? points : std::vector<ChartPoint>();
                })};
    if (chart.series.empty()) continue;
    texts.push_back(crossings(name, family));
    figure.charts.push_back(std::move(chart));
  }
  Section section =
      figure_section(std::move(figure), "Where fuzzy structures overtake refitting and rebuilding",
                     "Needs one animation at several sizes, named `NAME.mdk`, `NAME-split1.mdk`, "
                     "`NAME-split2.mdk` and so on.");
  section.blocks.insert(section.blocks.begin(), texts.begin(), texts.end());
  return section;
}

/// Bytes after each key that was measured. Only the trees of `static-kdtree` go on adding up past
/// those: by their mean.
std::vector<ChartPoint> memory_over_keys(const TechniqueBench& technique, std::uint32_t keys) {
  constexpr double kMiB = 1 << 20;
  std::vector<ChartPoint> points;
  for (const BenchFrame& frame : technique.frames)
    points.push_back({static_cast<double>(points.size() + 1),
                      static_cast<double>(frame.structure_bytes) / kMiB});
  const ChartPoint last = points.back();
  const double per_key = technique.id == "static-kdtree" ? last.y / last.x : 0;
  for (double x = last.x; x < keys;) {
    x = std::min<double>(2 * x, keys);
    points.push_back({x, last.y + per_key * (x - last.x)});
  }
  return points;
}

Section memory(const BenchRun& run) {
  const auto chart_of = [](const ModelBench& model) {
    return Chart{.title = model.name(),
                 .x_label = "keys made ready",
                 .y_label = "MiB",
                 .x_scale = Scale::kLog,
                 .y_scale = Scale::kLog,
                 .series = technique_series(model, [&](const TechniqueBench& technique) {
                   return memory_over_keys(technique, model.keys);
                 })};
  };
  return figure_section(
      {.id = "memory",
       .caption = "Memory of the structures, the mesh aside, once trees for so many keys were made "
                  "ready. Only `static-kdtree` needs one for each; past the keys measured its line "
                  "goes on by their mean. Both axes are logarithmic. Maps and boxes of clusters at "
                  "all keys count for the fuzzy techniques from the start.",
       .charts = charts_of_models(run, chart_of)},
      "Memory over the number of keys", "Needs a model that is not a subdivided one.");
}

std::string stop_text(const std::string& reason) {
  static const std::map<std::string, const char*> texts = {
      {"cost", "cost: another costs more than it saves"},
      {"percent", "percent: another gains too little"},
      {"count", "count: as many as asked for"},
      {"bones", "bones: one per bone"},
      {"limit", "limit: the most there may be"}};
  const auto found = texts.find(reason);
  return found == texts.end() ? reason : found->second;
}

Section bakes(const BenchRun& run) {
  std::vector<const ModelBench*> rows;
  for (const ModelBench& model : run.models)
    if (model.bake) rows.push_back(&model);
  const auto seconds = [](const char* head, double BakeFacts::Seconds::*part) {
    return Column<const ModelBench*>{
        head, [part](auto* m) { return fixed_text(m->bake->seconds.*part, 2); }};
  };
  Table table = table_of<const ModelBench*>(
      "From the bake's own reports: seconds of one run, residuals relative to the diagonal of the "
      "rest pose, cost as the expected work of a ray that hits the model's box.",
      rows,
      {{"model", [](auto* m) { return m->name(); }},
       {"stopped by", [](auto* m) { return stop_text(m->bake->stop_reason); }},
       {"triangles", [](auto* m) { return grouped_text(m->triangles); }},
       {"keys", [](auto* m) { return std::to_string(m->keys); }},
       {"clusters", [](auto* m) { return std::to_string(m->clusters); }},
       {"segments", [](auto* m) { return std::to_string(m->bake->segments); }},
       seconds("read s", &BakeFacts::Seconds::read),
       seconds("decompose s", &BakeFacts::Seconds::decompose),
       seconds("build s", &BakeFacts::Seconds::build),
       seconds("write s", &BakeFacts::Seconds::write),
       {"total s", [](auto* m) { return "**" + fixed_text(m->bake->seconds.total, 2) + "**"; }},
       {"residual rms", [](auto* m) { return percent_text(m->bake->residual_rms); }},
       {"largest", [](auto* m) { return percent_text(m->bake->residual_max); }},
       {"cost", [](auto* m) { return fixed_text(m->bake->sah_cost, 1); }},
       {"peak memory", [](auto* m) { return bytes_text(m->bake->peak_memory_bytes); }},
       {"file", [](auto* m) { return bytes_text(m->bake->file_bytes); }}},
      2);
  return {"bake",
          "What baking costs, and why it stopped",
          {or_needs(std::move(table),
                    "No bake reports stood beside the files: bake with `--report NAME.json` beside "
                    "`NAME.mdk`.")}};
}

// --- how it was measured ---

Section method(const BenchResults& results) {
  Section section{
      "method",
      "How this was measured",
      {Paragraph{
           "A first pass renders every key with every technique, counting on, and every key or "
           "some of them with brute force, which judges the hits: it gives counts, memory, work "
           "done ahead and mismatches, and no time. Then come the rounds: each technique in turn "
           "plays all keys once, after a frame that is not timed, and every round starts with "
           "another technique, so that a burst of load hits all of them. A frame counts as the "
           "fastest of its rounds, since what disturbs a machine only ever adds time; reported are "
           "medians over the frames."},
       Paragraph{
           "Counts depend on nothing but the files and the view: two runs give the same to the "
           "last digit (`auto` aside, which chooses by the clock). Nodes and clusters count once "
           "for a tile of rays that shares a frustum, triangle tests once for each ray; all are "
           "divided by all rays of the picture. Embree counts nothing; its trace time includes "
           "filling its ray packets."},
       Paragraph{"To see whether a change made a difference: `mdprep bench --compare old.json "
                 "new.json`."}}};
  if (!results.command.empty())
    section.blocks.push_back(Paragraph{"To measure again: `" + results.command + "`."});
  return section;
}

std::string or_unknown(const std::string& text) { return text.empty() ? "not given" : text; }

std::vector<std::pair<std::string, std::string>> facts_of(const BenchResults& results) {
  const BenchSetting& setting = results.runs.front().setting;
  const TechniqueBench& first = results.runs.front().models.front().techniques.front();
  const std::size_t rounds = first.round_medians_ms.size();
  return {
      {"Machine", or_unknown(results.machine.cpu) + ", " + std::to_string(results.machine.cores) +
                      (results.machine.cores == 1 ? " core" : " cores")},
      {"Instruction set", setting.isa},
      {"Threads", std::to_string(setting.threads)},
      {"Picture", std::to_string(setting.width) + " x " + std::to_string(setting.height) +
                      ", shading " + or_unknown(setting.shading)},
      {"Frames", std::to_string(first.frames.size()) + " keys of the first model, each timed in " +
                     std::to_string(rounds) + (rounds == 1 ? " round" : " rounds")},
      {"Program",
       "mdprep " + results.program.version + ", commit " + or_unknown(results.program.commit)},
      {"Compiler", or_unknown(results.program.compiler)},
      {"Command", "`" + or_unknown(results.command) + "`"}};
}

}  // namespace

std::string ratio_text(double a, double b) { return b > 0 ? fixed_text(a / b, 2) : "–"; }

std::string strong_ratio(double a, double b) {
  const std::string ratio = ratio_text(a, b);
  return b > 0 ? "**" + ratio + "**" : ratio;
}

std::string variant_of(const std::string& name) {
  for (const char* variant : {"paper", "bones", "space", "first", "level"})
    if (name.ends_with(std::string("-") + variant)) return variant;
  return {};
}

std::string base_name(const std::string& name) {
  const std::string variant = variant_of(name);
  return variant.empty() ? name : name.substr(0, name.size() - variant.size() - 1);
}

std::vector<const ModelBench*> whole_models(const BenchRun& run) {
  std::vector<const ModelBench*> models;
  for (const ModelBench& model : run.models)
    if (model.name().find("-split") == std::string::npos && variant_of(model.name()).empty())
      models.push_back(&model);
  return models;
}

std::vector<Chart> charts_of_models(const BenchRun& run,
                                    const std::function<Chart(const ModelBench&)>& chart_of) {
  std::vector<Chart> charts;
  for (const ModelBench* model : whole_models(run)) {
    charts.push_back(chart_of(*model));
    if (charts.back().series.empty()) charts.pop_back();
  }
  return charts;
}

std::vector<ChartSeries> technique_series(
    const ModelBench& model,
    const std::function<std::vector<ChartPoint>(const TechniqueBench&)>& points_of) {
  std::vector<ChartSeries> lines;
  const bool has_best = model.find("embree") != nullptr;
  for (const TechniqueBench& technique : model.techniques) {
    if (has_best && technique.id.starts_with("embree-")) continue;
    std::vector<ChartPoint> points = points_of(technique);
    if (!points.empty())
      lines.push_back({technique.id, technique_style(technique.id), std::move(points)});
  }
  return lines;
}

Block or_needs(Table table, const char* needs) {
  return table.rows.empty() ? Block(Paragraph{needs}) : Block(std::move(table));
}

Section figure_section(Figure figure, std::string title, const char* needs) {
  const std::string id = figure.id;
  if (figure.charts.empty()) return {id, std::move(title), {Paragraph{needs}}};
  return {id, std::move(title), {std::move(figure)}};
}

Report make_report(const BenchResults& results) {
  const BenchRun& run = results.runs.front();
  Report report{"Ray tracing animated meshes: every technique, measured", facts_of(results), {}};
  report.sections.push_back(summary(results));
  for (const auto& of_paper : {gfw06_sections, lo09_sections})
    for (Section& section : of_paper(run)) report.sections.push_back(std::move(section));
  report.sections.push_back(predicted_cost_section(run));
  report.sections.push_back(crossover(run));
  report.sections.push_back(memory(run));
  report.sections.push_back(bakes(run));
  if (results.runs.size() > 1) report.sections.push_back(machines(results));
  report.sections.push_back(detail_section(run));
  report.sections.push_back(method(results));
  return report;
}

}  // namespace mdk
