// mdprep bench of scenes: frames of a crowd, ours beside a hierarchy for each character that is
// refitted in every frame, judged by brute force where that is to be had.
#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "common/trace/scene_renderer.h"
#include "preprocess/bench/measurement.h"

namespace mdk {

struct SceneTechniqueBench {
  std::string id;
  double update_ms = 0, trace_ms = 0, shade_ms = 0, time_to_image_ms = 0;  ///< medians over frames
  double prebuild_ms = 0;
  double instances_entered_per_ray = 0;
  std::uint64_t instances_posed = 0;
  std::size_t structure_bytes = 0, cache_bytes = 0;
  std::uint64_t judged = 0, hit_mismatches = 0;  ///< pixels
};

struct SceneBench {
  std::string file;
  std::uint32_t instances = 0, width = 0, height = 0;
  std::vector<SceneTechniqueBench> techniques;
};

/// What is measured of a scene: `techniques` that scenes do not have are left out, and those that
/// would take more than 4 GiB.
SceneBench bench_scene(const std::string& path, const BenchConfig& config, ProgressSink& progress);

void print_scenes(std::ostream& out, const std::vector<SceneBench>& scenes);
std::string scenes_json(const std::vector<SceneBench>& scenes);

}  // namespace mdk
