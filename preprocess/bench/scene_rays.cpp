#include "preprocess/bench/scene_rays.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "common/base/isa.h"
#include "common/base/parallel.h"
#include "common/base/stopwatch.h"
#include "common/motion/model_handle.h"
#include "common/trace/scene_tracer.h"
#include "common/trace/techniques/embree_scene_rays.h"
#include "formats/mds/mds_file.h"
#include "preprocess/tool/measures.h"

namespace mdk {
namespace {

constexpr std::size_t kRaysPerChunk = 64;
constexpr std::uint64_t kJudgedTriangles = 100'000'000;  // tested by brute force, at most
constexpr float kSameDepth = 1e-4f;
constexpr double kSeconds = 10;  // of the scene's clock that random times are drawn from

struct TimedRay {
  QueryRay ray;
  double time;
};

/// A lidar of 32 beams in the middle of the scene, at three quarters of its height; it turns ten
/// times in half a second.
std::vector<TimedRay> spin(const Aabb& bounds, std::uint32_t count) {
  constexpr std::uint32_t kBeams = 32;
  constexpr double kTurns = 10;
  const Vec3f eye = bounds.lo + Vec3f{bounds.extent().x * 0.5f, bounds.extent().y * 0.75f,
                                      bounds.extent().z * 0.5f};
  std::vector<TimedRay> rays;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i / kBeams * kBeams) / count;
    const double turn = 2 * std::numbers::pi * kTurns * share;
    const double rise = (static_cast<double>(i % kBeams) / (kBeams - 1) - 0.6) * 0.6;
    rays.push_back(
        {{eye,
          {static_cast<float>(std::cos(turn) * std::cos(rise)), static_cast<float>(std::sin(rise)),
           static_cast<float>(std::sin(turn) * std::cos(rise))}},
         0.5 * share});
  }
  return rays;
}

/// Lines that hit the scene's box, each equally likely, at random times.
std::vector<TimedRay> random_lines(const Aabb& box, std::uint32_t count) {
  std::mt19937_64 engine(1);
  const auto unit = [&] { return static_cast<float>(engine() >> 40) * 0x1p-24f; };
  const Vec3f e = box.extent();
  const float sides[3] = {e.y * e.z, e.z * e.x, e.x * e.y};
  std::vector<TimedRay> rays;
  for (std::uint32_t i = 0; i < count; ++i) {
    float place = unit() * (sides[0] + sides[1] + sides[2]);
    std::size_t axis = 0;
    while (axis < 2 && place >= sides[axis]) place -= sides[axis++];
    const bool from_high = unit() < 0.5f;
    const float out = std::sqrt(unit()), turn = 2 * std::numbers::pi_v<float> * unit();
    Vec3f origin, direction;
    origin[axis] = from_high ? e[axis] : 0;
    direction[axis] = std::sqrt(std::max(0.0f, 1 - out * out)) * (from_high ? -1.0f : 1.0f);
    for (const std::size_t k : {1u, 2u}) {
      const std::size_t other = (axis + k) % 3;
      origin[other] = e[other] * unit();
      direction[other] = out * (k == 1 ? std::cos(turn) : std::sin(turn));
    }
    rays.push_back({{box.lo + origin, direction}, kSeconds * static_cast<double>(unit())});
  }
  return rays;
}

bool is_same(const SceneHit& a, const SceneHit& b) {
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
  return a.instance == b.instance && a.triangle == b.triangle && bits(a.t) == bits(b.t) &&
         bits(a.bary1) == bits(b.bary1) && bits(a.bary2) == bits(b.bary2);
}

template <class Tracer>
void trace_all(const Tracer& tracer, const std::vector<TimedRay>& rays, RayAim aim,
               std::vector<SceneHit>& hits) {
  parallel_chunks(rays.size(), kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      hits[i] = tracer.trace(rays[i].ray, rays[i].time, aim);
  });
}

/// Brute force for some of the rays, spread evenly.
void judge(const Stage& stage, const std::vector<TimedRay>& rays, RayAim aim,
           const std::vector<SceneHit>& hits, std::uint32_t count, RayBenchRow& row) {
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::size_t i = std::size_t{k} * hits.size() / count;
    const SceneHit expected = brute_force_closest_hit(stage, rays[i].ray, rays[i].time);
    ++row.judged;
    row.mismatches +=
        aim == RayAim::kAny ? hits[i].is_hit() != expected.is_hit() : !is_same(hits[i], expected);
  }
}

bool is_different(const SceneHit& ours, const SceneHit& peer, RayAim aim) {
  if (ours.is_hit() != peer.is_hit()) return true;
  return aim == RayAim::kClosest && ours.is_hit() &&
         std::abs(ours.t - peer.t) > kSameDepth * std::abs(ours.t);
}

}  // namespace

RayBench bench_scene_rays(const std::string& path, const RayBenchConfig& config,
                          ProgressSink& progress) {
  const MdsFile file(path);
  const Stage& stage = file.stage();
  RayBench bench{path, std::string(isa_in_use()), {}, 0, 0, config.rays,
                 {},   stage.instance_count()};
  std::uint64_t triangles = 0;
  for (const SceneInstance& instance : stage.scene().instances)
    triangles += stage.models()[stage.scene().roles[instance.role()].model].triangle_count();
  for (const Model& model : stage.models()) {
    bench.triangles += model.triangle_count();
    bench.keys += model.key_count();
  }
  const Stopwatch watch;
  const SceneTracer tracer(stage);
  const double build_ms = watch.milliseconds();
  const auto robust = make_embree_scene_rays(stage, PeerMode::kRobust),
             plain = make_embree_scene_rays(stage, PeerMode::kPlain);
  if (robust != nullptr) bench.peer = "embree-3";

  const std::vector<TimedRay> spins = spin(tracer.trees().bounds(), config.rays),
                              lines = random_lines(tracer.trees().bounds(), config.rays);
  struct Run {
    const char* name;
    const std::vector<TimedRay>& rays;
    RayAim aim;
  };
  const Run runs[] = {{"spin", spins, RayAim::kClosest},
                      {"random", lines, RayAim::kClosest},
                      {"random-any", lines, RayAim::kAny}};
  std::vector<int> threads{1};
  if (thread_count() > 1) threads.push_back(thread_count());
  double done = 0;
  for (const Run& run : runs) {
    std::vector<SceneHit> first;
    for (const int count : threads) {
      progress.report("time", done / static_cast<double>(std::size(runs) * threads.size()));
      done += 1;
      check_loop();
      const ThreadLimit limit(count);
      RayBenchRow row;
      row.row = run.name;
      row.threads = count;
      std::vector<SceneHit> hits(config.rays), peer_hits(config.rays);
      std::vector<std::function<void()>> traces{
          [&] { trace_all(tracer, run.rays, run.aim, hits); }};
      std::vector<double*> results{&row.ours_ns};
      traces[0]();
      std::size_t hit_count = 0;
      for (const SceneHit& hit : hits) hit_count += hit.is_hit();
      row.hits = std::round(1e3 * static_cast<double>(hit_count) / config.rays) / 1e3;
      if (first.empty()) {
        const std::uint64_t most = kJudgedTriangles / std::max<std::uint64_t>(triangles, 1) + 1;
        judge(stage, run.rays, run.aim, hits,
              static_cast<std::uint32_t>(std::min<std::uint64_t>(config.judged, most)), row);
        first = hits;
      } else {
        for (std::size_t i = 0; i < hits.size(); ++i)
          row.mismatches += run.aim == RayAim::kAny ? hits[i].is_hit() != first[i].is_hit()
                                                    : !is_same(hits[i], first[i]);
      }
      if (robust != nullptr) {
        trace_all(*robust, run.rays, run.aim, peer_hits);
        for (std::size_t i = 0; i < hits.size(); ++i)
          row.peer_differs += is_different(hits[i], peer_hits[i], run.aim);
        traces.emplace_back([&] { trace_all(*robust, run.rays, run.aim, peer_hits); });
        traces.emplace_back([&] { trace_all(*plain, run.rays, run.aim, peer_hits); });
        results.insert(results.end(), {&row.peer_ns, &row.plain_ns});
        row.peer_bytes = robust->bytes();
        row.peer_build_ms = robust->build_ms();
      }
      std::vector<std::vector<double>> ns(traces.size());
      for (std::uint32_t round = 0; round < config.rounds; ++round)
        for (std::size_t k = 0; k < traces.size(); ++k) {
          const std::size_t i = (k + round) % traces.size();
          const Stopwatch lap;
          traces[i]();
          ns[i].push_back(lap.seconds() * 1e9 / config.rays);
        }
      for (std::size_t i = 0; i < traces.size(); ++i)
        *results[i] = std::round(median(std::move(ns[i])) * 10) / 10;
      row.ours_bytes = tracer.own_bytes() + tracer.model_bytes();
      row.ours_build_ms = build_ms;
      bench.rows.push_back(row);
    }
  }
  return bench;
}

}  // namespace mdk
