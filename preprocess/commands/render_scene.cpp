#include "preprocess/commands/render_scene.h"

#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/base/text.h"
#include "common/trace/scene_renderer.h"
#include "formats/files/image_writer.h"
#include "formats/mds/mds_file.h"
#include "preprocess/commands/film_writer.h"
#include "preprocess/tool/files.h"
#include "preprocess/tool/measures.h"
#include "preprocess/tool/progress_bar.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

struct SceneFrame {
  std::uint32_t number = 0;
  double seconds = 0;
};

std::vector<SceneFrame> plan_frames(const SceneRenderArguments& arguments, const SceneView& scene) {
  constexpr std::uint32_t kMostFrames = 1u << 30;
  if (arguments.time_seconds) {
    const double number = (*arguments.time_seconds - scene.first_time) * kSceneFrameRate;
    return {{number > 0 && number < kMostFrames ? static_cast<std::uint32_t>(number) : 0,
             *arguments.time_seconds}};
  }
  if (!arguments.frames) return {{0, scene.first_time}};
  std::vector<SceneFrame> frames;
  for (const std::uint32_t number : arguments.frames->keys(kMostFrames))
    frames.push_back({number, scene.first_time + number / kSceneFrameRate});
  return frames;
}

/// Holds all of the scene at all times.
Aabb bounds_of(const Stage& stage) {
  Aabb bounds;
  for (std::uint32_t i = 0; i < stage.instance_count(); ++i) bounds.extend(stage.box_always(i));
  return bounds;
}

/// When each sample is taken, the first in the middle; nothing where all are taken at once.
std::vector<double> sample_times(double seconds, double open, std::uint32_t samples) {
  std::vector<double> times;
  for (std::uint32_t i = 0; open > 0 && i < samples; ++i)
    times.push_back(seconds + open * (EvenPoint::fraction(0.5 + i / std::numbers::phi) - 0.5));
  return times;
}

Json stats_row(const SceneFrame& frame, const SceneStats& stats, const SceneStats& counted,
               const SceneRenderer& renderer) {
  const auto rays = static_cast<double>(counted.rays);
  const WorkPerRay work = work_per_ray(counted.counters.work, counted.rays);
  return {
      {"frame", frame.number},
      {"time", frame.seconds},
      {"update_ms", stats.update_ms},
      {"trace_ms", stats.trace_ms},
      {"shade_ms", stats.shade_ms},
      {"time_to_image_ms", stats.time_to_image_ms()},
      {"prebuild_ms", stats.prebuild_ms},
      {"rays", stats.rays},
      {"hits", stats.hits},
      {"instances_posed", stats.instances_posed},
      {"instances_entered_per_ray", static_cast<double>(counted.counters.instances_entered) / rays},
      {"node_visits_per_ray", work.node_visits},
      {"leaf_triangles_per_ray", work.leaf_triangles},
      {"triangle_tests_per_ray", work.triangle_tests},
      {"clusters_per_ray", work.clusters},
      {"structure_bytes", renderer.structure_bytes()},
      {"cache_bytes", renderer.cache_bytes()}};
}

SceneTechnique technique_of(const std::string& id) {
  if (id == "fuzzy-bvh") return SceneTechnique::kFuzzy;
  if (id == "refit-bvh") return SceneTechnique::kRefit;
  if (id == "brute-force") return SceneTechnique::kBruteForce;
  throw Error(
      ErrorCode::kUsage,
      "--technique " + id + ": scenes are rendered with fuzzy-bvh, refit-bvh or brute-force");
}

void check_outputs(const SceneRenderArguments& arguments, const std::vector<SceneFrame>& frames) {
  if (frames.size() > 1 && !has_number_place(arguments.output) && !is_film(arguments.output))
    throw Error(ErrorCode::kUsage,
                arguments.output + ": " + std::to_string(frames.size()) +
                    " frames need a place for their number, as in out_####.png; or choose one "
                    "frame with --time");
  const std::string outputs[] = {numbered_path(arguments.output, frames.front().number),
                                 arguments.stats};
  require_distinct_files(arguments.input, outputs);
  require_writable_place(outputs[0]);
  if (!arguments.stats.empty()) require_writable_place(arguments.stats);
}

}  // namespace

void render_scene(const SceneRenderArguments& arguments, CommandContext& context) {
  const SceneTechnique technique = technique_of(arguments.technique);
  const MdsFile file(arguments.input);
  const Stage& stage = file.stage();
  const std::vector<SceneFrame> frames = plan_frames(arguments, stage.scene());
  check_outputs(arguments, frames);
  const LoopCheck interrupts = context.interrupts.defer();
  ProgressBar progress(std::cerr, progress_style(arguments.messages));
  const ImageSize size = arguments.view.size;
  SceneRequest request;
  request.width = size.width;
  request.height = size.height;
  request.shading = arguments.view.shading;
  request.samples = arguments.view.samples;
  request.camera = arguments.view.camera ? *arguments.view.camera
                                         : choose_camera(arguments.view, bounds_of(stage));
  SceneRenderer renderer(stage, {.technique = technique, .cache_bytes = arguments.cache_bytes});

  std::optional<FilmWriter> film;
  if (is_film(arguments.output))
    film.emplace(arguments.output, size, kSceneFrameRate, context.overwrite);
  Json rows = Json::array();
  std::vector<double> times;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    progress.report("render", static_cast<double>(i) / static_cast<double>(frames.size()));
    request.time = frames[i].seconds;
    const std::vector<double> shutter =
        sample_times(frames[i].seconds, arguments.shutter_seconds, request.samples);
    request.shutter = shutter;
    request.counting = false;
    const SceneStats stats = renderer.render(request);
    times.push_back(stats.time_to_image_ms());
    const std::string path = numbered_path(arguments.output, frames[i].number);
    if (film) {
      film->add(renderer.pixels());
    } else {
      write_png(path, size.width, size.height, renderer.pixels(), context.overwrite);
      context.outputs.push_back(path);
    }
    if (arguments.stats.empty()) continue;
    request.counting = true;  // a second time, since counting slows a frame down
    rows.push_back(stats_row(frames[i], stats, renderer.trace(request), renderer));
  }
  if (film) {
    film->finish();
    context.outputs = {arguments.output};
  }
  context.inputs = {arguments.input};
  for (std::uint32_t m = 0; m < stage.models().size(); ++m)
    context.inputs.push_back(file.model_path(m));
  if (!arguments.stats.empty()) {
    const Json report = {{"schema", "mdprep-render/1"},
                         {"file", arguments.input},
                         {"isa", isa_in_use()},
                         {"threads", thread_count()},
                         {"width", size.width},
                         {"height", size.height},
                         {"technique", arguments.technique},
                         {"shading", shading_id(arguments.view.shading)},
                         {"samples", arguments.view.samples},
                         {"instances", stage.instance_count()},
                         {"frames", rows}};
    write_text_file(arguments.stats,
                    report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
  }
  if (arguments.messages.quiet) return;
  progress.clear();
  std::cerr << printable_line(arguments.output) << ": " << frames.size()
            << (frames.size() == 1 ? " frame of " : " frames of ") << stage.instance_count()
            << " instances, " << fixed_text(median(times), 2) << " ms to the image (median, "
            << arguments.technique << ", " << thread_count()
            << (thread_count() == 1 ? " thread, " : " threads, ") << isa_in_use() << ")\n";
}

}  // namespace mdk
