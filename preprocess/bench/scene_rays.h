// mdprep bench --rays of scenes: single rays at times of their own among many characters, beside
// Embree's shared motion blur with remapped time.
#pragma once

#include <string>

#include "preprocess/bench/rays.h"

namespace mdk {

/// Rows spin, random and random-any, for one thread and for all that may be used now. Throws what
/// opening the file throws.
RayBench bench_scene_rays(const std::string& path, const RayBenchConfig& config,
                          ProgressSink& progress);

}  // namespace mdk
