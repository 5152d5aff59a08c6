#include "preprocess/bench/measurement.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>

#include "preprocess/tool/measures.h"
#include "preprocess/tool/shared_options.h"

namespace mdk {
namespace {

using Renderers = std::vector<std::unique_ptr<Renderer>>;

/// Pass 0 is about as much work as brute force on every key: a guess, for progress alone.
constexpr double kCountUntil = 0.5;

FrameRequest request_of(const BenchConfig& config, std::uint32_t key) {
  FrameRequest request = config.request;
  request.at = at_key(key);
  return request;
}

/// To 10 ns, below which a clock has nothing to say: files stay short and say what pages show.
double rounded(double milliseconds) { return std::round(milliseconds * 1e5) / 1e5; }

/// Adds a frame for each key to each technique's result.
void count_and_judge(const ModelView& model, const BenchConfig& config, Renderers& renderers,
                     std::vector<TechniqueBench>& results, ProgressSink& progress) {
  Renderer oracle(model, "brute-force");
  const std::vector<std::uint32_t> keys = spread_keys(config.frames, model.key_count());
  const auto count = static_cast<std::uint32_t>(keys.size());
  const std::vector<std::uint32_t> judged = spread_keys(config.judged, count);
  for (std::uint32_t k = 0; k < count; ++k) {
    progress.report("count", static_cast<double>(k) / count);
    FrameRequest request = request_of(config, keys[k]);
    const bool is_judged = std::binary_search(judged.begin(), judged.end(), k);
    if (is_judged) oracle.trace(request);
    request.counting = Counting::kOn;
    for (std::size_t i = 0; i < renderers.size(); ++i) {
      const FrameStats& stats = renderers[i]->trace(request);
      TechniqueBench& result = results[i];
      BenchFrame frame;
      frame.key = keys[k];
      frame.counters = stats.counters;
      frame.hits = stats.hits;
      frame.structure_bytes = renderers[i]->structure_bytes();
      result.frames.push_back(frame);
      result.rays_per_frame = stats.rays;
      result.prebuild_ms += stats.prebuild_ms;
      if (!is_judged) continue;
      ++result.judged_frames;
      result.hit_mismatches += count_mismatches(renderers[i]->hits(), oracle.hits(),
                                                find_technique(result.id).agreement());
    }
    progress.report("count", static_cast<double>(k + 1) / count);
  }
}

void time_round(const BenchConfig& config, Renderer& renderer, TechniqueBench& result) {
  renderer.render(request_of(config, result.frames.front().key));  // untimed: warms the caches
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

std::string processor_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) continue;
    const std::size_t begin = line.find_first_not_of(" \t", colon + 1);
    if (begin != std::string::npos) return line.substr(begin);
  }
  return "unknown processor";
}

}  // namespace

std::vector<TechniqueBench> bench_techniques(const ModelView& model, const BenchConfig& config,
                                             ProgressSink& progress) {
  const std::size_t count = config.techniques.size();
  std::vector<TechniqueBench> results(count);
  Renderers renderers;
  for (std::size_t i = 0; i < count; ++i) {
    results[i].id = config.techniques[i];
    results[i].kd_cost_ratio = rounded(find_technique(results[i].id).kd_cost_ratio);
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

BenchMachine this_machine() {
  const long cores = sysconf(_SC_NPROCESSORS_ONLN);
  return {processor_name(), cores > 0 ? static_cast<int>(cores) : 1};
}

BenchProgram this_program(const std::string& commit) { return {MDK_VERSION, commit, MDK_COMPILER}; }

}  // namespace mdk
