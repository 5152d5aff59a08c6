#include "tests/preprocess/bench/made_up_results.h"

namespace mdk::test {

TechniqueBench made_up_technique(const std::string& id, double factor) {
  TechniqueBench technique;
  technique.id = id;
  technique.rays_per_frame = 100;
  technique.structure_bytes = 2048;
  technique.prebuild_ms = 7;
  technique.judged_frames = 2;
  if (id.ends_with("kdtree")) technique.kd_cost_ratio = 0.25;
  for (const double ms : {3.0, 1.0, 2.0}) {
    BenchFrame frame;
    frame.key = static_cast<std::uint32_t>(technique.frames.size()) * 5;
    frame.pose_ms = 0.5 * factor;
    frame.update_ms = ms * factor;
    frame.trace_ms = 10 * ms * factor;
    frame.shade_ms = 4 * factor;
    frame.counters.node_visits = 300;
    frame.counters.leaf_triangles = 40;
    frame.counters.triangle_tests = 200;
    frame.counters.clusters_entered = 50;
    frame.hits = 50;
    frame.structure_bytes = 1024 * (technique.frames.size() + 1);
    technique.frames.push_back(frame);
  }
  technique.round_medians_ms = {27 * factor, 26 * factor};
  return technique;
}

BakeFacts made_up_bake() {
  BakeFacts bake;
  bake.segments = 1;
  bake.stop_reason = "cost";
  bake.residual_rms = 0.001;
  bake.residual_max = 0.02;
  bake.sah_cost = 7.5;
  bake.seconds.decompose = 2;
  bake.seconds.total = 2.5;
  bake.peak_memory_bytes = 1 << 20;
  bake.file_bytes = 1 << 18;
  bake.growth = {{1, 0.1, 103, 100}, {2, 0.05, 44, 40}, {4, 0.01, 17, 10}};
  return bake;
}

BenchResults made_up_results() {
  ModelBench hand{"out/hand.mdk", 16000, 11, 4, made_up_bake(), {}};
  for (const auto& [id, factor] : {std::pair{"fuzzy-bvh", 1.0},
                                   {"fuzzy-kdtree", 1.5},
                                   {"static-kdtree", 1.2},
                                   {"rebuild-bvh", 2.0},
                                   {"refit-bvh", 0.9},
                                   {"decomp-refit", 1.3},
                                   {"embree", 2.5}})
    hand.techniques.push_back(made_up_technique(id, factor));
  ModelBench split = hand;
  split.file = "out/hand-split1.mdk";
  split.triangles = 64000;
  split.bake.reset();
  split.techniques = {made_up_technique("fuzzy-bvh", 2), made_up_technique("refit-bvh", 3),
                      made_up_technique("rebuild-bvh", 8)};
  BenchRun two_threads{{"avx2", 2, 10, 10, "diffuse"}, {hand}};
  two_threads.models.front().techniques = {made_up_technique("fuzzy-bvh", 0.5),
                                           made_up_technique("embree", 1.5)};
  return {{"Processor <1> & co", 2},
          {"0.1.0", "abc1234", "GNU 12, -O2"},
          "./run bench",
          {{{"avx2", 1, 10, 10, "diffuse"}, {hand, split}}, two_threads}};
}

}  // namespace mdk::test
