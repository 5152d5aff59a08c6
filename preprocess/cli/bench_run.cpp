#include "preprocess/cli/bench_run.h"

#include <memory>

#include "common/trace/renderer.h"
#include "preprocess/cli/median.h"
#include "preprocess/cli/progress_bar.h"

namespace mdk {
namespace {

using Renderers = std::vector<std::unique_ptr<Renderer>>;

/// Pass 0 is about as much work as brute force on every key: a guess, for progress alone.
constexpr double kCountUntil = 0.5;

FrameRequest request_of(const BenchConfig& config, std::uint32_t key) {
  FrameRequest request;
  request.at = at_key(key);
  request.camera = config.camera;
  request.width = config.width;
  request.height = config.height;
  request.shading = config.shading;
  return request;
}

void count_and_judge(const Model& model, const BenchConfig& config, Renderers& renderers,
                     std::vector<TechniqueBench>& results, ProgressSink& progress) {
  Renderer oracle(model, "brute-force");
  for (std::size_t k = 0; k < config.keys.size(); ++k) {
    const double share = 1.0 / static_cast<double>(config.keys.size());
    progress.report("count", static_cast<double>(k) * share);
    FrameRequest request = request_of(config, config.keys[k]);
    oracle.trace(request);
    request.counting = Counting::kOn;
    for (std::size_t i = 0; i < renderers.size(); ++i) {
      const FrameStats& stats = renderers[i]->trace(request);
      results[i].counters += stats.counters;
      results[i].rays += stats.rays;
      results[i].prebuild_ms += stats.prebuild_ms;
      results[i].hit_mismatches += count_mismatches(renderers[i]->hits(), oracle.hits(),
                                                    find_technique(results[i].id).agreement());
    }
    progress.report("count", static_cast<double>(k + 1) * share);
  }
}

void time_round(const BenchConfig& config, Renderer& renderer, TechniqueBench& result) {
  renderer.render(request_of(config, config.keys.front()));  // untimed: warms the caches
  for (std::size_t k = 0; k < config.keys.size(); ++k) {
    const FrameStats& stats = renderer.render(request_of(config, config.keys[k]));
    if (result.frames.size() == k) {
      result.frames.push_back({config.keys[k], stats});
    } else {
      keep_faster(result.frames[k], stats);
    }
  }
}

template <class Value>
double median_over(const std::vector<BenchFrame>& frames, const Value& value) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const BenchFrame& frame : frames) values.push_back(value(frame.stats));
  return median(std::move(values));
}

}  // namespace

FrameStats TechniqueBench::median_phases() const {
  FrameStats phases;
  phases.pose_ms = median_over(frames, [](const FrameStats& s) { return s.pose_ms; });
  phases.update_ms = median_over(frames, [](const FrameStats& s) { return s.update_ms; });
  phases.trace_ms = median_over(frames, [](const FrameStats& s) { return s.trace_ms; });
  phases.shade_ms = median_over(frames, [](const FrameStats& s) { return s.shade_ms; });
  return phases;
}

double TechniqueBench::median_time_to_image_ms() const {
  return median_over(frames, [](const FrameStats& s) { return s.time_to_image_ms(); });
}

void keep_faster(BenchFrame& frame, const FrameStats& another) {
  if (another.time_to_image_ms() < frame.stats.time_to_image_ms()) frame.stats = another;
}

std::vector<TechniqueBench> bench_techniques(const Model& model, const BenchConfig& config,
                                             ProgressSink& progress) {
  const std::size_t count = config.techniques.size();
  std::vector<TechniqueBench> results(count);
  Renderers renderers;
  for (std::size_t i = 0; i < count; ++i) {
    results[i].id = config.techniques[i];
    renderers.push_back(std::make_unique<Renderer>(model, config.techniques[i]));
  }
  ProgressPart counting(progress, 0, kCountUntil);
  count_and_judge(model, config, renderers, results, counting);

  ProgressPart timing(progress, kCountUntil, 1);
  const std::size_t turns = config.rounds * count;
  for (std::size_t turn = 0; turn < turns; ++turn) {
    timing.report("time", static_cast<double>(turn) / static_cast<double>(turns));
    const std::size_t i = (turn + turn / count) % count;  // each round starts one further on
    time_round(config, *renderers[i], results[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    results[i].structure_bytes = renderers[i]->structure_bytes();
    results[i].note = renderers[i]->technique_note();
  }
  return results;
}

}  // namespace mdk
