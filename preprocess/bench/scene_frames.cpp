#include "preprocess/bench/scene_frames.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "common/base/isa.h"
#include "common/base/text.h"
#include "formats/mds/mds_file.h"
#include "preprocess/tool/measures.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMostTriangles = 2e7;       // brute force poses and tests all of them
constexpr std::uint32_t kJudgedSide = 192;   // of its picture
constexpr double kMostRefitted = 4e9;        // bytes
constexpr double kRefittedPerTriangle = 20;  // bytes: a node's share and posed corners

double triangles_of(const Stage& stage) {
  double sum = 0;
  for (std::uint32_t i = 0; i < stage.instance_count(); ++i)
    sum += stage.model_of(i).triangle_count();
  return sum;
}

}  // namespace

SceneBench bench_scene(const std::string& path, const BenchConfig& config, ProgressSink& progress) {
  const MdsFile file(path);
  const Stage& stage = file.stage();
  const double triangles = triangles_of(stage);
  SceneBench bench{path, stage.instance_count(), config.request.width, config.request.height, {}};
  SceneRequest request;
  request.camera = config.request.camera;
  request.width = config.request.width;
  request.height = config.request.height;
  request.shading = config.request.shading;
  request.samples = config.request.samples;
  const double from = stage.scene().first_time, length = stage.scene().last_time - from;
  const auto time_of = [&](std::uint32_t frame) {
    return from + length * (frame + 0.5) / config.frames;
  };

  struct Row {
    const char* id;
    SceneTechnique technique;
  };
  for (const Row& row :
       {Row{"fuzzy-bvh", SceneTechnique::kFuzzy}, Row{"refit-bvh", SceneTechnique::kRefit}}) {
    if (std::ranges::find(config.techniques, row.id) == config.techniques.end()) continue;
    if (row.technique == SceneTechnique::kRefit && triangles * kRefittedPerTriangle > kMostRefitted)
      continue;
    SceneRenderer renderer(stage, {.technique = row.technique});
    SceneTechniqueBench& result = bench.techniques.emplace_back();
    result.id = row.id;
    request.time = time_of(0);
    request.counting = false;
    result.prebuild_ms = renderer.render(request).prebuild_ms;  // keys are decoded here, too
    std::vector<double> update, trace, shade, image;
    for (std::uint32_t frame = 0; frame < config.frames; ++frame) {
      progress.report("bench", static_cast<double>(frame) / config.frames);
      request.time = time_of(frame);
      SceneStats best;
      for (std::uint32_t round = 0; round < std::max(1u, config.rounds); ++round) {
        const SceneStats stats = renderer.render(request);
        if (round == 0 || stats.time_to_image_ms() < best.time_to_image_ms()) best = stats;
      }
      update.push_back(best.update_ms);
      trace.push_back(best.trace_ms);
      shade.push_back(best.shade_ms);
      image.push_back(best.time_to_image_ms());
    }
    result.update_ms = median(update);
    result.trace_ms = median(trace);
    result.shade_ms = median(shade);
    result.time_to_image_ms = median(image);
    request.counting = true;
    const SceneStats counted = renderer.trace(request);
    result.instances_posed = counted.instances_posed;
    result.instances_entered_per_ray =
        static_cast<double>(counted.counters.instances_entered) / static_cast<double>(counted.rays);
    result.structure_bytes = renderer.structure_bytes();
    result.cache_bytes = renderer.cache_bytes();
    if (config.judged == 0 || triangles > kMostTriangles) continue;
    SceneRenderer oracle(stage, {.technique = SceneTechnique::kBruteForce});
    SceneRequest judged = request;
    judged.counting = false;
    judged.width = std::min(judged.width, kJudgedSide);
    judged.height = std::min(judged.height, kJudgedSide);
    oracle.trace(judged);
    renderer.trace(judged);
    result.judged = std::uint64_t{judged.width} * judged.height;
    result.hit_mismatches = count_mismatches(oracle.hits(), renderer.hits());
  }
  return bench;
}

void print_scenes(std::ostream& out, const std::vector<SceneBench>& scenes) {
  TextTable table(2);
  table.add_row({"scene", "instances", "technique", "update ms", "trace ms", "shade ms", "image ms",
                 "posed", "structure MB", "cache MB", "judged", "mismatches"});
  for (const SceneBench& scene : scenes)
    for (const SceneTechniqueBench& t : scene.techniques)
      table.add_row({std::filesystem::path(scene.file).stem().string(),
                     std::to_string(scene.instances), t.id, fixed_text(t.update_ms, 3),
                     fixed_text(t.trace_ms, 1), fixed_text(t.shade_ms, 1),
                     fixed_text(t.time_to_image_ms, 1), std::to_string(t.instances_posed),
                     fixed_text(static_cast<double>(t.structure_bytes) * 1e-6, 2),
                     fixed_text(static_cast<double>(t.cache_bytes) * 1e-6, 1),
                     std::to_string(t.judged), std::to_string(t.hit_mismatches)});
  table.print(out);
}

std::string scenes_json(const std::vector<SceneBench>& scenes) {
  Json list = Json::array();
  for (const SceneBench& scene : scenes) {
    Json rows = Json::array();
    for (const SceneTechniqueBench& t : scene.techniques)
      rows.push_back({{"id", t.id},
                      {"update_ms", t.update_ms},
                      {"trace_ms", t.trace_ms},
                      {"shade_ms", t.shade_ms},
                      {"time_to_image_ms", t.time_to_image_ms},
                      {"prebuild_ms", t.prebuild_ms},
                      {"instances_entered_per_ray", t.instances_entered_per_ray},
                      {"instances_posed", t.instances_posed},
                      {"structure_bytes", t.structure_bytes},
                      {"cache_bytes", t.cache_bytes},
                      {"judged", t.judged},
                      {"hit_mismatches", t.hit_mismatches}});
    list.push_back({{"file", std::filesystem::path(scene.file).filename().string()},
                    {"instances", scene.instances},
                    {"techniques", std::move(rows)}});
  }
  Json report{{"schema", "mdprep-bench/1"}, {"isa", isa_in_use()}, {"threads", thread_count()}};
  if (!scenes.empty()) {
    report["width"] = scenes.front().width;
    report["height"] = scenes.front().height;
  }
  report["models"] = std::move(list);
  return report.dump(2) + "\n";
}

}  // namespace mdk
