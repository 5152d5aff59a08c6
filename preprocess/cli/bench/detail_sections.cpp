// Every technique on every model, and how the figures were taken.
#include "preprocess/cli/bench/sections.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

std::string percent(double share) { return fixed_text(share * 100, 1) + " %"; }

std::vector<std::string> detail_row(const TechniqueBench& t) {
  const Quartiles image = t.time_to_image_ms();
  const WorkPerRay work = t.work();
  const bool counts = work.node_visits > 0 || work.triangle_tests > 0;
  const auto count = [&](double value) { return counts ? fixed_text(value, 3) : std::string("–"); };
  return {"`" + t.id + "`",
          fixed_text(t.median_pose_ms(), 2),
          fixed_text(t.median_update_ms(), 3),
          fixed_text(t.median_trace_ms(), 2),
          fixed_text(t.median_shade_ms(), 2),
          "**" + fixed_text(image.median, 2) + "**",
          fixed_text(image.low, 2) + "–" + fixed_text(image.high, 2),
          percent(t.unrest()),
          fixed_text(image.median > 0 ? 1000 / image.median : 0, 1),
          count(work.node_visits),
          count(work.triangle_tests),
          count(work.clusters),
          bytes_text(t.structure_bytes),
          fixed_text(t.prebuild_ms, 1),
          grouped_text(t.hit_mismatches)};
}

}  // namespace

Section detail_section(const BenchRun& run) {
  Section section{"details", "Every technique on every model", {}};
  section.blocks.push_back(Paragraph{
      "Medians over the frames in milliseconds; the middle half of the time to image over the "
      "animation; unrest: how far the second fastest round lay behind the fastest; work per ray; "
      "memory of "
      "the structures; all work done ahead for these keys; pixels that differ from brute force."});
  for (const ModelBench& model : run.models) {
    section.blocks.push_back(
        Paragraph{"**" + model.name() + "**: " + grouped_text(model.triangles) + " triangles, " +
                  grouped_text(model.keys) + " keys, " + grouped_text(model.clusters) +
                  " clusters; " + std::to_string(model.techniques.front().frames.size()) +
                  " frames, " + std::to_string(model.techniques.front().round_medians_ms.size()) +
                  " rounds; brute force judged " +
                  std::to_string(model.techniques.front().judged_frames) + "."});
    Table table;
    table.head = {"technique",     "pose",         "update", "trace",    "shade",
                  "time to image", "middle half",  "unrest", "fps",      "visits/ray",
                  "tests/ray",     "clusters/ray", "memory", "prebuild", "mismatches"};
    for (const TechniqueBench& technique : model.techniques)
      table.rows.push_back(detail_row(technique));
    section.blocks.push_back(std::move(table));
    for (const TechniqueBench& technique : model.techniques)
      if (!technique.note.empty())
        section.blocks.push_back(Paragraph{"`" + technique.id + "`: " + technique.note + "."});
  }
  return section;
}

Section method_section(const BenchResults& results) {
  Section section{"method", "How this was measured", {}};
  section.blocks.push_back(Paragraph{
      "A first pass renders every key with every technique, counting on, and every key or some of "
      "them with brute force, which judges the hits: it gives counts, memory, work done ahead and "
      "mismatches, and no time. Then come the rounds: "
      "each technique in turn plays all keys once, after a frame that is not timed, and every "
      "round "
      "starts with another technique, so that a burst of load hits all of them. A frame counts as "
      "the fastest of its rounds, since what disturbs a machine only ever adds time; reported are "
      "medians over the frames."});
  section.blocks.push_back(Paragraph{
      "Counts depend on nothing but the files and the view: two runs give the same to the last "
      "digit (`auto` aside, which chooses by the clock). Nodes and clusters count once for a tile "
      "of rays that shares a frustum, triangle tests once for each ray; all are divided by all "
      "rays "
      "of the picture. Embree counts nothing; its trace time includes filling its ray packets."});
  section.blocks.push_back(Paragraph{
      "To see whether a change made a difference: `mdprep bench --compare old.json new.json`."});
  if (!results.command.empty())
    section.blocks.push_back(Paragraph{"To measure again: `" + results.command + "`."});
  return section;
}

}  // namespace mdk
