// Single rays, timed in turn with a peer's: rays of a lidar that spins beside the model, of a scan
// aimed at it, and of no preferred place or direction, each at a time of its own; then many at one
// time. What is hit is judged by brute force.
#include "preprocess/bench/rays.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <ostream>
#include <random>

#include "common/base/isa.h"
#include "common/base/stopwatch.h"
#include "common/motion/model_handle.h"
#include "common/trace/brute_force.h"
#include "common/trace/techniques/embree_rays.h"
#include "preprocess/tool/measures.h"

namespace mdk {
namespace {

constexpr std::size_t kRaysPerChunk = 64;
constexpr std::uint32_t kJudgedTriangles = 40'000'000;  // tested by brute force, at most
constexpr float kSameDepth = 1e-4f;

struct RayList {
  std::vector<QueryRay> rays;
  std::vector<KeyInterval> times;
};

/// Every interval between keys of all clips.
std::vector<KeyInterval> intervals_of(const ModelView& model) {
  std::vector<KeyInterval> intervals;
  for (const Clip& clip : model.clips)
    for (std::uint32_t i = 0; i + 1 < clip.key_count; ++i)
      intervals.push_back({clip.first_key + i, clip.first_key + i + 1, 0});
  if (intervals.empty()) intervals.push_back(at_key(0));
  return intervals;
}

/// Up to sixteen in the middle: about half a second.
std::vector<KeyInterval> short_while(const ModelView& model) {
  constexpr std::size_t kIntervals = 16;
  const std::vector<KeyInterval> all = intervals_of(model);
  const std::size_t count = std::min(kIntervals, all.size()), first = (all.size() - count) / 2;
  return {all.begin() + static_cast<std::ptrdiff_t>(first),
          all.begin() + static_cast<std::ptrdiff_t>(first + count)};
}

/// At `share` of [0, 1) of the intervals, one after another.
KeyInterval time_at(const std::vector<KeyInterval>& intervals, double share) {
  const double place = share * static_cast<double>(intervals.size());
  KeyInterval at = intervals[std::min(static_cast<std::size_t>(place), intervals.size() - 1)];
  if (at.key0 != at.key1)
    at.s = std::min(static_cast<float>(place - std::floor(place)), std::nextafter(1.0f, 0.0f));
  return at;
}

Aabb box_at(const ModelView& model, const KeyInterval& at) {
  const Aabb a = model.key_boxes[at.key0], b = model.key_boxes[at.key1];
  return {a.lo + (b.lo - a.lo) * at.s, a.hi + (b.hi - a.hi) * at.s};
}

/// A lidar of 32 beams, two diagonals away, that turns ten times in a short while.
RayList spin(const ModelView& model, std::uint32_t count) {
  constexpr std::uint32_t kBeams = 32;
  constexpr double kTurns = 10;
  const std::vector<KeyInterval> intervals = short_while(model);
  const float size = diagonal(model.bounds);
  const Vec3f eye = model.bounds.center() + Vec3f{1.2f, 0.3f, 1.57f} * size;
  RayList list;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i / kBeams * kBeams) / count;
    const double turn = 2 * std::numbers::pi * kTurns * share;
    const double rise = (static_cast<double>(i % kBeams) / (kBeams - 1) - 0.6) * 0.6;
    list.rays.push_back(
        {eye,
         {static_cast<float>(std::cos(turn) * std::cos(rise)), static_cast<float>(std::sin(rise)),
          static_cast<float>(std::sin(turn) * std::cos(rise))}});
    list.times.push_back(time_at(intervals, share));
  }
  return list;
}

/// From the same place, ten pictures of the model's box one after another in a short while,
/// read out row by row.
RayList scan(const ModelView& model, std::uint32_t count) {
  constexpr std::uint32_t kPictures = 10;
  const std::vector<KeyInterval> intervals = short_while(model);
  const float size = diagonal(model.bounds);
  const Vec3f eye = model.bounds.center() + Vec3f{1.2f, 0.3f, 1.57f} * size;
  const std::uint32_t side = std::max(1u, static_cast<std::uint32_t>(std::sqrt(count / kPictures)));
  RayList list;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / count;
    const KeyInterval at = time_at(intervals, share);
    const Aabb box = box_at(model, at);
    const Vec3f along = box.center() - eye;
    const Vec3f right = normalized(cross(along, Vec3f{0, 1, 0})),
                up = normalized(cross(right, along));
    Vec3f half;  // of the box, seen along `right` and `up`
    for (std::size_t axis = 0; axis < 3; ++axis) {
      half.x += std::abs(right[axis]) * box.extent()[axis] / 2;
      half.y += std::abs(up[axis]) * box.extent()[axis] / 2;
    }
    const float x = (static_cast<float>(i % side) + 0.5f) / static_cast<float>(side) * 2 - 1;
    const float y = (static_cast<float>(i / side % side) + 0.5f) / static_cast<float>(side) * 2 - 1;
    list.rays.push_back({eye, along + right * (half.x * x) + up * (half.y * y)});
    list.times.push_back(at);
  }
  return list;
}

/// Lines that hit a box, each equally likely (isotropic, uniform): they enter it at a point of a
/// face drawn by area, at an angle drawn by its cosine.
class RandomLines {
 public:
  QueryRay next(const Aabb& box) {
    const Vec3f e = box.extent();
    const float sides[3] = {e.y * e.z, e.z * e.x, e.x * e.y};
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
    return {box.lo + origin, direction};
  }
  double share() { return std::uniform_real_distribution<double>(0, 1)(engine_); }

 private:
  float unit() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
  std::mt19937_64 engine_{1};
};

RayList random_rays(const ModelView& model, std::uint32_t count,
                    const std::optional<KeyInterval>& moment) {
  const std::vector<KeyInterval> intervals = intervals_of(model);
  RandomLines lines;
  RayList list;
  for (std::uint32_t i = 0; i < count; ++i) {
    const KeyInterval at = moment ? *moment : time_at(intervals, lines.share());
    list.rays.push_back(lines.next(box_at(model, at)));
    list.times.push_back(at);
  }
  return list;
}

/// One row's rays, and who traces them.
struct RayRun {
  std::string name;
  const RayList& list;
  RayAim aim;
  bool at_one_time;
};

using Trace = std::function<void(std::vector<QueryHit>& hits)>;

Trace trace_by(const PeerRays& peer, const RayRun& run) {
  std::vector<PeerRays::Time> times;
  for (const KeyInterval& at : run.list.times) times.push_back(peer.at(at));
  return [&peer, &run, times = std::move(times)](std::vector<QueryHit>& hits) {
    parallel_chunks(hits.size(), kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        hits[i] = peer.trace(run.list.rays[i], times[i], run.aim);
    });
  };
}

QueryHit as_hit(bool is_hit) { return is_hit ? QueryHit{0, 0, 0, 0} : QueryHit{}; }

Trace trace_by(const RayQuery& query, const RayRun& run) {
  if (run.at_one_time) {
    const QueryMoment moment = query.prepare(run.list.times[0]);
    return [&query, &run, moment](std::vector<QueryHit>& hits) {
      const RayList& list = run.list;
      parallel_chunks(hits.size(), kRaysPerChunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          hits[i] = run.aim == RayAim::kAny ? as_hit(query.any_hit(list.rays[i], moment))
                                            : query.closest_hit(list.rays[i], moment);
      });
    };
  }
  const RayList& list = run.list;
  if (run.aim == RayAim::kClosest)
    return [&](std::vector<QueryHit>& hits) {
      query.closest_hits(list.rays.data(), list.times.data(), hits.data(), hits.size());
    };
  return [&](std::vector<QueryHit>& hits) {
    std::vector<std::uint8_t> is_hit(hits.size());
    query.any_hits(list.rays.data(), list.times.data(), is_hit.data(), is_hit.size());
    for (std::size_t i = 0; i < hits.size(); ++i) hits[i] = as_hit(is_hit[i] != 0);
  };
}

bool is_same(const QueryHit& a, const QueryHit& b) {
  const auto bits = [](float f) { return std::bit_cast<std::uint32_t>(f); };
  return a.triangle == b.triangle && bits(a.t) == bits(b.t) && bits(a.bary1) == bits(b.bary1) &&
         bits(a.bary2) == bits(b.bary2);
}

/// Rays, spread evenly, for which we do not see what brute force sees.
void judge(const ModelView& model, const RayRun& run, const std::vector<QueryHit>& hits,
           std::uint32_t count, RayBenchRow& row) {
  PosedMesh mesh(model);
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::size_t i = std::size_t{k} * hits.size() / count;
    mesh.set_time(run.list.times[i]);
    const QueryHit expected = brute_force_closest_hit(mesh, run.list.rays[i]);
    ++row.judged;
    row.mismatches += run.aim == RayAim::kAny ? hits[i].is_hit() != expected.is_hit()
                                              : !is_same(hits[i], expected);
  }
}

std::uint32_t count_different(const std::vector<QueryHit>& ours,
                              const std::vector<QueryHit>& peer) {
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const bool both = ours[i].is_hit() && peer[i].is_hit();
    count += ours[i].is_hit() != peer[i].is_hit() ||
             (both && std::abs(ours[i].t - peer[i].t) > kSameDepth * std::abs(ours[i].t));
  }
  return count;
}

/// Medians of all, taken in turn.
void time_row(std::vector<Trace*> traces, std::uint32_t rays, std::uint32_t rounds,
              std::vector<double*> results) {
  std::vector<std::vector<double>> ns(traces.size());
  std::vector<QueryHit> hits(rays);
  for (std::uint32_t round = 0; round < rounds; ++round) {
    for (std::size_t k = 0; k < traces.size(); ++k) {
      const std::size_t i = (k + round) % traces.size();
      const Stopwatch watch;
      (*traces[i])(hits);
      ns[i].push_back(watch.seconds() * 1e9 / rays);
    }
  }
  for (std::size_t i = 0; i < traces.size(); ++i)
    *results[i] = std::round(median(std::move(ns[i])) * 10) / 10;
}

double rounded(double value) { return std::round(value * 1e3) / 1e3; }

struct Peers {
  std::unique_ptr<PeerRays> robust, plain;

  Peers(const ModelView& model, const std::optional<KeyInterval>& moment)
      : robust(make_embree_rays(model, PeerMode::kRobust, moment)),
        plain(make_embree_rays(model, PeerMode::kPlain, moment)) {}
};

void run_rows(const ModelView& model, const RayQuery& query, double build_ms, const Peers& peers,
              const RayRun& run, const RayBenchConfig& config, RayBench& bench) {
  std::vector<int> threads{1};
  if (thread_count() > 1) threads.push_back(thread_count());
  std::vector<QueryHit> first;
  for (const int count : threads) {
    const ThreadLimit limit(count);
    RayBenchRow row;
    row.row = run.name;
    row.threads = count;
    Trace ours = trace_by(query, run), robust, plain;
    std::vector<QueryHit> hits(config.rays), peer_hits(config.rays);
    ours(hits);
    for (const QueryHit& hit : hits) row.hits += hit.is_hit() ? 1.0 / config.rays : 0;
    row.hits = rounded(row.hits);
    if (first.empty()) {
      judge(model, run, hits,
            std::min(config.judged, kJudgedTriangles / model.triangle_count() + 1), row);
      first = hits;
    } else {
      for (std::size_t i = 0; i < hits.size(); ++i) row.mismatches += !is_same(hits[i], first[i]);
    }
    std::vector<Trace*> traces{&ours};
    std::vector<double*> results{&row.ours_ns};
    if (peers.robust != nullptr) {
      robust = trace_by(*peers.robust, run);
      plain = trace_by(*peers.plain, run);
      robust(peer_hits);
      if (run.aim == RayAim::kClosest) {
        row.peer_differs = count_different(hits, peer_hits);
      } else {
        for (std::size_t i = 0; i < hits.size(); ++i)
          row.peer_differs += hits[i].is_hit() != peer_hits[i].is_hit();
      }
      traces.insert(traces.end(), {&robust, &plain});
      results.insert(results.end(), {&row.peer_ns, &row.plain_ns});
      row.peer_bytes = peers.robust->bytes();
      row.peer_build_ms = rounded(peers.robust->build_ms());
    }
    time_row(traces, config.rays, config.rounds, results);
    row.ours_bytes = query.bytes();
    row.ours_build_ms = rounded(build_ms);
    bench.rows.push_back(row);
  }
}

}  // namespace

RayBench bench_rays(const std::string& path, const RayBenchConfig& config, ProgressSink& progress) {
  const Model loaded = Model::load(path);
  const ModelView& model = ModelHandle::view(loaded);
  RayBench bench{path,
                 std::string(isa_in_use()),
                 {},
                 model.triangle_count(),
                 model.key_count(),
                 config.rays,
                 {},
                 0};
  const Stopwatch watch;
  const RayQuery query(loaded);
  const double build_ms = watch.milliseconds();
  const std::vector<KeyInterval> intervals = intervals_of(model);
  const KeyInterval moment = time_at(intervals, 0.55);
  const RayList spins = spin(model, config.rays), scans = scan(model, config.rays),
                lines = random_rays(model, config.rays, {}),
                still = random_rays(model, config.rays, moment);
  const RayRun runs[] = {
      {"spin", spins, RayAim::kClosest, false},   {"scan", scans, RayAim::kClosest, false},
      {"random", lines, RayAim::kClosest, false}, {"random-any", lines, RayAim::kAny, false},
      {"moment", still, RayAim::kClosest, true},  {"moment-any", still, RayAim::kAny, true}};
  std::unique_ptr<Peers> peers;
  for (std::size_t i = 0; i < std::size(runs); ++i) {
    progress.report("time", static_cast<double>(i) / static_cast<double>(std::size(runs)));
    check_loop();
    if (i == 0 || runs[i].at_one_time != runs[i - 1].at_one_time) {
      peers.reset();
      peers = std::make_unique<Peers>(model,
                                      runs[i].at_one_time ? std::optional(moment) : std::nullopt);
      if (peers->robust != nullptr) bench.peer = "embree-3";
    }
    run_rows(model, query, build_ms, *peers, runs[i], config, bench);
  }
  return bench;
}

}  // namespace mdk
