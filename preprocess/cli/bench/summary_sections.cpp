// The figures that matter most: fuzzy structures beside Embree and beside what they replace.
#include <algorithm>

#include "preprocess/cli/bench/sections.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

const std::vector<std::string> kFuzzy = {"fuzzy-bvh", "fuzzy-kdtree"};
const std::vector<std::string> kEmbree = {"embree", "embree-refit", "embree-low", "embree-medium"};
const std::vector<std::string> kRebuiltOrRefit = {"rebuild-bvh", "refit-bvh", "tsah-refit",
                                                  "hybrid-bvh", "decomp-refit"};

std::string time_text(const TechniqueBench* technique) {
  if (technique == nullptr) return "–";
  const Quartiles image = technique->time_to_image_ms();
  return fixed_text(image.median, 2);
}

std::string time_and_id(const TechniqueBench* technique) {
  return technique == nullptr ? "–" : time_text(technique) + " `" + technique->id + "`";
}

std::string ratio_text(double a, double b) { return b > 0 ? fixed_text(a / b, 2) : "–"; }

/// How many times as fast `technique` is as `other`.
std::string speed_text(const TechniqueBench* technique, const TechniqueBench* other) {
  if (technique == nullptr || other == nullptr) return "–";
  return "**" + ratio_text(other->time_to_image_ms().median, technique->time_to_image_ms().median) +
         "**";
}

std::vector<std::string> summary_row(const ModelBench& model) {
  const TechniqueBench* fuzzy = fastest_of(model, kFuzzy);
  const TechniqueBench* embree = fastest_of(model, kEmbree);
  const TechniqueBench* other = fastest_of(model, kRebuiltOrRefit);
  const TechniqueBench* bvh = model.find("fuzzy-bvh");
  const TechniqueBench* rebuilt = model.find("rebuild-bvh");
  return {model.name(),
          grouped_text(model.triangles),
          std::to_string(model.clusters),
          time_and_id(fuzzy),
          time_and_id(embree),
          speed_text(fuzzy, embree),
          time_and_id(other),
          speed_text(fuzzy, other),
          bvh != nullptr && rebuilt != nullptr
              ? ratio_text(bvh->median_trace_ms(), rebuilt->median_trace_ms())
              : "–",
          bvh != nullptr ? fixed_text(bvh->median_update_ms(), 3) : "–"};
}

std::vector<std::string> machine_row(const BenchRun& run, const ModelBench& model) {
  const TechniqueBench* fuzzy = fastest_of(model, kFuzzy);
  const TechniqueBench* embree = fastest_of(model, kEmbree);
  return {model.name(),
          run.isa,
          std::to_string(run.threads),
          run.shading,
          grouped_text(model.triangles),
          time_and_id(fuzzy),
          time_and_id(embree),
          speed_text(fuzzy, embree)};
}

/// The run that differs from `run` in one thread alone, or null.
const BenchRun* one_thread_run(const BenchResults& results, const BenchRun& run) {
  for (const BenchRun& other : results.runs)
    if (other.threads == 1 && other.isa == run.isa && other.width == run.width &&
        other.height == run.height && other.shading == run.shading)
      return &other;
  return nullptr;
}

/// A row per model and technique that was measured with one thread and with more.
Table thread_table(const BenchResults& results) {
  Table table;
  table.head = {"model",       "technique", "instruction set", "threads",
                "1 thread ms", "ms",        "times as fast"};
  table.left_columns = 3;
  for (const BenchRun& run : results.runs) {
    const BenchRun* single = run.threads > 1 ? one_thread_run(results, run) : nullptr;
    if (single == nullptr) continue;
    for (const ModelBench& model : run.models) {
      const ModelBench* before = single->find(model.name());
      if (before == nullptr) continue;
      for (const TechniqueBench& technique : model.techniques)
        if (const TechniqueBench* one = before->find(technique.id))
          table.rows.push_back({model.name(), "`" + technique.id + "`", run.isa,
                                std::to_string(run.threads), time_text(one), time_text(&technique),
                                speed_text(&technique, one)});
    }
  }
  return table;
}

std::string mismatch_sentence(const BenchResults& results) {
  std::uint64_t ours = 0, peers = 0, pixels = 0;
  for (const BenchRun& run : results.runs)
    for (const ModelBench& model : run.models)
      for (const TechniqueBench& technique : model.techniques) {
        const bool is_peer = technique.id.rfind("embree", 0) == 0;
        (is_peer ? peers : ours) += technique.hit_mismatches;
        pixels += technique.rays_per_frame * technique.judged_frames;
      }
  return "Of " + grouped_text(pixels) + " pixels judged by brute force, " + grouped_text(ours) +
         " differ in a technique of ours (bit by bit), " + grouped_text(peers) +
         " in Embree (another triangle, and a depth that differs by more than 1e-5).";
}

}  // namespace

Section summary_section(const BenchResults& results) {
  const BenchRun& run = results.runs.front();
  Section section{"summary", "At a glance", {}};
  section.blocks.push_back(Paragraph{
      "Median time to image in milliseconds (pose + update + trace + shade) of the faster fuzzy "
      "structure, of Embree in its fastest mode and of the fastest structure that is refitted or "
      "rebuilt; how many times as fast the fuzzy one is; trace time of `fuzzy-bvh` over that of a "
      "hierarchy built for the very key (`rebuild-bvh`); its update in milliseconds."});
  Table table;
  table.head = {
      "model",         "triangles",           "clusters",      "fuzzy ms",          "Embree ms",
      "times as fast", "refit or rebuilt ms", "times as fast", "trace / rebuilt's", "update ms"};
  for (const ModelBench& model : run.models) table.rows.push_back(summary_row(model));
  section.blocks.push_back(std::move(table));
  section.blocks.push_back(Paragraph{mismatch_sentence(results)});
  return section;
}

Section machine_section(const BenchResults& results) {
  Section section{"machines", "Instruction sets and threads", {}};
  section.blocks.push_back(Paragraph{
      "Median time to image in milliseconds of the faster fuzzy structure and of Embree in its "
      "fastest mode, both held to the same instruction set and threads. Lit pictures have a shadow "
      "ray and 16 rays of ambient occlusion for every pixel that hits."});
  Table table;
  table.head = {"model",     "instruction set", "threads",   "shading",
                "triangles", "fuzzy ms",        "Embree ms", "times as fast"};
  table.left_columns = 2;
  for (const ModelBench& model : results.runs.front().models)
    for (const BenchRun& run : results.runs)
      if (const ModelBench* same = run.find(model.name()))
        table.rows.push_back(machine_row(run, *same));
  section.blocks.push_back(std::move(table));
  Table threads = thread_table(results);
  if (!threads.rows.empty()) {
    section.blocks.push_back(Paragraph{"More threads beside one:"});
    section.blocks.push_back(std::move(threads));
  }
  return section;
}

Table technique_table_of(const BenchRun& run, const std::vector<std::string>& models) {
  Table table;
  table.head = {"technique"};
  std::vector<const ModelBench*> found;
  for (const std::string& name : models)
    if (const ModelBench* model = run.find(name)) found.push_back(model);
  for (const ModelBench* model : found) {
    table.head.push_back(model->name() + " (" + grouped_text(model->triangles) +
                         " triangles): update");
    for (const char* column : {"trace", "to image", "memory"}) table.head.emplace_back(column);
  }
  std::vector<std::string> ids;
  for (const ModelBench* model : found)
    for (const TechniqueBench& technique : model->techniques)
      if (std::find(ids.begin(), ids.end(), technique.id) == ids.end()) ids.push_back(technique.id);
  for (const std::string& id : ids) {
    std::vector<std::string> row = {"`" + id + "`"};
    for (const ModelBench* model : found) {
      const TechniqueBench* t = model->find(id);
      row.push_back(t ? fixed_text(t->median_update_ms(), 2) : "–");
      row.push_back(t ? fixed_text(t->median_trace_ms(), 1) : "–");
      row.push_back(t ? fixed_text(t->time_to_image_ms().median, 1) : "–");
      row.push_back(t ? bytes_text(t->structure_bytes) : "–");
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace mdk
