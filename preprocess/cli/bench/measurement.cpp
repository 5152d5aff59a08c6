#include "preprocess/cli/bench/measurement.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "common/trace/renderer.h"
#include "preprocess/cli/key_range.h"
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
  request.samples = config.samples;
  request.occlusion_rays = config.occlusion_rays;
  return request;
}

/// To 10 ns, below which a clock has nothing to say: files stay short and say what pages show.
double rounded(double milliseconds) { return std::round(milliseconds * 1e5) / 1e5; }

bool is_among(const std::vector<std::uint32_t>& rising, std::size_t value) {
  return std::binary_search(rising.begin(), rising.end(), value);
}

void count_and_judge(const Model& model, const BenchConfig& config, Renderers& renderers,
                     std::vector<TechniqueBench>& results, ProgressSink& progress) {
  Renderer oracle(model, "brute-force");
  const auto frames = static_cast<std::uint32_t>(config.keys.size());
  const std::vector<std::uint32_t> judged = spread_keys(config.judged, frames);
  for (std::size_t k = 0; k < config.keys.size(); ++k) {
    const double share = 1.0 / static_cast<double>(config.keys.size());
    progress.report("count", static_cast<double>(k) * share);
    FrameRequest request = request_of(config, config.keys[k]);
    const bool is_judged = is_among(judged, k);
    if (is_judged) oracle.trace(request);
    request.counting = Counting::kOn;
    for (std::size_t i = 0; i < renderers.size(); ++i) {
      const FrameStats& stats = renderers[i]->trace(request);
      TechniqueBench& result = results[i];
      BenchFrame frame;
      frame.key = config.keys[k];
      frame.counters = stats.counters;
      frame.structure_bytes = renderers[i]->structure_bytes();
      result.frames.push_back(frame);
      result.rays_per_frame = stats.rays;
      result.prebuild_ms += stats.prebuild_ms;
      if (!is_judged) continue;
      ++result.judged_frames;
      result.hit_mismatches += count_mismatches(renderers[i]->hits(), oracle.hits(),
                                                find_technique(result.id).agreement());
    }
    progress.report("count", static_cast<double>(k + 1) * share);
  }
}

void time_round(const BenchConfig& config, Renderer& renderer, TechniqueBench& result) {
  renderer.render(request_of(config, config.keys.front()));  // untimed: warms the caches
  const bool first_round = result.round_medians_ms.empty();
  std::vector<double> times;
  for (BenchFrame& frame : result.frames) {
    const FrameStats& stats = renderer.render(request_of(config, frame.key));
    BenchFrame timed = frame;
    timed.pose_ms = rounded(stats.pose_ms);
    timed.update_ms = rounded(stats.update_ms);
    timed.trace_ms = rounded(stats.trace_ms);
    timed.shade_ms = rounded(stats.shade_ms);
    times.push_back(timed.time_to_image_ms());
    if (first_round) {
      frame = timed;
    } else {
      keep_faster(frame, timed);
    }
  }
  result.round_medians_ms.push_back(rounded(median(std::move(times))));
}

}  // namespace

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
    results[i].prebuild_ms = rounded(results[i].prebuild_ms);
    results[i].note = renderers[i]->technique_note();
  }
  return results;
}

}  // namespace mdk
