// The tables that list every technique on every model: on a page, at a terminal, as CSV, and in
// documents that quote them.
#include <algorithm>
#include <charconv>

#include "common/base/text.h"
#include "preprocess/bench/report.h"

namespace mdk {
namespace {

enum class Place { kCsv, kTerminal, kPage };

struct TechniqueRow {
  const BenchSetting& setting;
  const ModelBench& model;
  const TechniqueBench& technique;
  Quartiles image = technique.time_to_image_ms();
  WorkPerRay work = technique.work();
};

/// A figure of every technique: its head in each place, or null where it is not shown there.
struct Listed {
  const char *csv, *terminal, *page;
  std::function<std::string(const TechniqueRow&, Place)> text;

  const char* head(Place place) const {
    return place == Place::kCsv ? csv : place == Place::kTerminal ? terminal : page;
  }
};

/// In CSV the shortest text that reads as the same number.
std::string number(double value, Place place, int decimals) {
  if (place != Place::kCsv) return fixed_text(value, decimals);
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// One of the row's or the technique's own figures.
template <class Figure>
auto figure(const Figure& figure_of, int decimals) {
  return [=](const TechniqueRow& r, Place place) { return number(figure_of(r), place, decimals); };
}

auto phase(double BenchFrame::*ms, int decimals) {
  return figure([=](auto& r) { return r.technique.median_ms(ms); }, decimals);
}

/// Peers count nothing: a dash on pages.
auto work(double WorkPerRay::*count) {
  return [=](const TechniqueRow& r, Place place) {
    const bool counts = r.work.node_visits > 0 || r.work.triangle_tests > 0;
    return place == Place::kPage && !counts ? "–" : number(r.work.*count, place, 3);
  };
}

/// The same, and a dash where an older program did not count them.
std::string leaf_triangles(const TechniqueRow& r, Place place) {
  if (place != Place::kCsv && !r.technique.has_leaf_counts())
    return place == Place::kPage ? "–" : "-";
  return work(&WorkPerRay::leaf_triangles)(r, place);
}

const Listed kListed[] = {
    {"file", nullptr, nullptr, [](auto& r, Place) { return r.model.file; }},
    {nullptr, "model", nullptr, [](auto& r, Place) { return r.model.name(); }},
    {"isa", nullptr, nullptr, [](auto& r, Place) { return r.setting.isa; }},
    {"threads", nullptr, nullptr, [](auto& r, Place) { return std::to_string(r.setting.threads); }},
    {"width", nullptr, nullptr, [](auto& r, Place) { return std::to_string(r.setting.width); }},
    {"height", nullptr, nullptr, [](auto& r, Place) { return std::to_string(r.setting.height); }},
    {"triangles", nullptr, nullptr,
     [](auto& r, Place) { return std::to_string(r.model.triangles); }},
    {"keys", nullptr, nullptr, [](auto& r, Place) { return std::to_string(r.model.keys); }},
    {"clusters", nullptr, nullptr, [](auto& r, Place) { return std::to_string(r.model.clusters); }},
    {"id", "technique", nullptr, [](auto& r, Place) { return r.technique.id; }},
    {nullptr, nullptr, "technique", [](auto& r, Place) { return "`" + r.technique.id + "`"; }},
    {"pose_ms", "pose ms", "pose", phase(&BenchFrame::pose_ms, 2)},
    {"update_ms", "update ms", nullptr, phase(&BenchFrame::update_ms, 2)},
    {nullptr, nullptr, "update", phase(&BenchFrame::update_ms, 3)},
    {"trace_ms", "trace ms", "trace", phase(&BenchFrame::trace_ms, 2)},
    {"shade_ms", "shade ms", "shade", phase(&BenchFrame::shade_ms, 2)},
    {"time_to_image_ms", "image ms", nullptr, figure([](auto& r) { return r.image.median; }, 2)},
    {nullptr, nullptr, "time to image",
     [](auto& r, Place) { return "**" + fixed_text(r.image.median, 2) + "**"; }},
    {nullptr, "middle half", "middle half",
     [](auto& r, Place place) {
       return fixed_text(r.image.low, 2) + (place == Place::kPage ? "–" : "-") +
              fixed_text(r.image.high, 2);
     }},
    {nullptr, nullptr, "round spread",
     [](auto& r, Place) { return fixed_text(100 * r.technique.round_spread(), 1) + " %"; }},
    {"fps", "fps", "fps", figure([](auto& r) { return r.technique.fps(); }, 1)},
    {"node_visits_per_ray", "visits/ray", "visits/ray", work(&WorkPerRay::node_visits)},
    {"leaf_triangles_per_ray", "leaf tri./ray", "leaf tri./ray", leaf_triangles},
    {"triangle_tests_per_ray", "tests/ray", "tests/ray", work(&WorkPerRay::triangle_tests)},
    {"clusters_per_ray", "clusters/ray", "clusters/ray", work(&WorkPerRay::clusters)},
    {"structure_bytes", "memory", "memory",
     [](auto& r, Place place) {
       const std::uint64_t bytes = r.technique.structure_bytes;
       return place == Place::kCsv ? std::to_string(bytes) : bytes_text(bytes);
     }},
    {"prebuild_ms", "prebuild ms", "prebuild",
     figure([](auto& r) { return r.technique.prebuild_ms; }, 1)},
    {"hit_mismatches", "mismatches", "mismatches",
     [](auto& r, Place place) {
       const std::uint64_t pixels = r.technique.hit_mismatches;
       return place == Place::kPage ? grouped_text(pixels) : std::to_string(pixels);
     }},
    {"time_to_image_low_ms", nullptr, nullptr, figure([](auto& r) { return r.image.low; }, 0)},
    {"time_to_image_high_ms", nullptr, nullptr, figure([](auto& r) { return r.image.high; }, 0)},
    {"unrest", nullptr, nullptr, figure([](auto& r) { return r.technique.round_spread(); }, 0)},
};

void append_rows(const BenchSetting& setting, const ModelBench& model,
                 std::vector<TechniqueRow>& rows) {
  for (const TechniqueBench& technique : model.techniques)
    rows.push_back({setting, model, technique});
}

Table listed_table(Place place, std::string text, const std::vector<TechniqueRow>& rows,
                   std::size_t left_columns = 1) {
  std::vector<Column<TechniqueRow>> columns;
  for (const Listed& listed : kListed)
    if (const char* head = listed.head(place))
      columns.push_back({head, [&](auto& row) { return listed.text(row, place); }});
  return table_of(std::move(text), rows, columns, left_columns);
}

}  // namespace

Section detail_section(const BenchRun& run) {
  Section section{
      "details",
      "Every technique on every model",
      {Paragraph{
          "Medians over the frames in milliseconds; the middle half of the time to image over the "
          "animation; round spread: how far the second fastest round lay behind the fastest; work "
          "per ray (boxes or kd steps; triangles of the leaves entered, before any is culled; "
          "tests "
          "evaluated after culling; clusters entered); memory of the structures; all work done "
          "ahead for these keys; pixels that differ "
          "from brute force."}}};
  for (const ModelBench& model : run.models) {
    std::vector<TechniqueRow> rows;
    append_rows(run.setting, model, rows);
    const TechniqueBench& first = model.techniques.front();
    section.blocks.push_back(
        listed_table(Place::kPage,
                     "**" + model.name() + "**: " + grouped_text(model.triangles) + " triangles, " +
                         grouped_text(model.keys) + " keys, " + grouped_text(model.clusters) +
                         " clusters" + (model.between_keys ? "" : " (boxes hold at keys only)") +
                         "; " + std::to_string(first.frames.size()) + " frames, " +
                         std::to_string(first.round_medians_ms.size()) +
                         " rounds; brute force judged " + std::to_string(first.judged_frames) + ".",
                     rows));
    for (const TechniqueBench& technique : model.techniques)
      if (!technique.note.empty())
        section.blocks.push_back(Paragraph{"`" + technique.id + "`: " + technique.note + "."});
  }
  return section;
}

Table technique_table_of(const BenchRun& run, const std::vector<std::string>& models) {
  std::vector<std::string> ids;
  std::vector<Column<std::string>> columns = {
      {"technique", [](auto& id) { return "`" + id + "`"; }}};
  for (const std::string& name : models) {
    const ModelBench* model = run.find(name);
    if (model == nullptr) continue;
    for (const TechniqueBench& technique : model->techniques)
      if (std::find(ids.begin(), ids.end(), technique.id) == ids.end()) ids.push_back(technique.id);
    const auto add = [&](std::string head, std::string (*cell)(const TechniqueBench&)) {
      columns.push_back({std::move(head), [=](auto& id) {
                           const TechniqueBench* technique = model->find(id);
                           return technique == nullptr ? "–" : cell(*technique);
                         }});
    };
    add(name + " (" + grouped_text(model->triangles) + " triangles): update",
        [](auto& t) { return fixed_text(t.median_ms(&BenchFrame::update_ms), 2); });
    add("trace", [](auto& t) { return fixed_text(t.median_ms(&BenchFrame::trace_ms), 1); });
    add("to image", [](auto& t) { return fixed_text(t.time_to_image_ms().median, 1); });
    add("memory", [](auto& t) { return bytes_text(t.structure_bytes); });
  }
  return table_of("", ids, columns);
}

Table printed_table(const BenchRun& run) {
  std::vector<TechniqueRow> rows;
  for (const ModelBench& model : run.models) append_rows(run.setting, model, rows);
  return listed_table(Place::kTerminal, "", rows, 2);
}

Table csv_table(const BenchResults& results) {
  std::vector<TechniqueRow> rows;
  for (const BenchRun& run : results.runs)
    for (const ModelBench& model : run.models) append_rows(run.setting, model, rows);
  return listed_table(Place::kCsv, "", rows);
}

}  // namespace mdk
