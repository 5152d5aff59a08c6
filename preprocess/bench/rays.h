// mdprep bench --rays: what single rays cost, beside Embree's motion blur and static hierarchies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "common/base/parallel.h"

namespace mdk {

/// One kind of rays on one number of threads. Times are medians over the rounds, in ns a ray.
struct RayBenchRow {
  std::string row;
  int threads = 1;
  double ours_ns = 0, peer_ns = 0, plain_ns = 0;  ///< 0 without a peer
  double hits = 0;                                ///< share of the rays that hit
  std::size_t ours_bytes = 0, peer_bytes = 0;
  double ours_build_ms = 0, peer_build_ms = 0;
  std::uint32_t judged = 0;        ///< rays compared with brute force
  std::uint32_t mismatches = 0;    ///< of those, and between numbers of threads
  std::uint32_t peer_differs = 0;  ///< rays for which the peer sees another thing or depth

  /// How many times the peer's time is ours.
  double ratio() const { return ours_ns > 0 ? peer_ns / ours_ns : 0; }
};

struct RayBench {
  std::string file;
  std::string isa;
  std::string peer;  ///< empty without
  std::uint32_t triangles = 0, keys = 0, rays = 0;
  std::vector<RayBenchRow> rows;
  std::uint32_t instances = 0;  ///< of a scene
};

struct RayBenchConfig {
  std::uint32_t rays = 20'000, rounds = 11, judged = 200;
};

/// Rows for one thread, and for all that may be used now. Throws what opening the file throws.
RayBench bench_rays(const std::string& path, const RayBenchConfig& config, ProgressSink& progress);

/// "mdk-rays/1".
std::string rays_json(const std::vector<RayBench>& models);
void print_rays(std::ostream& out, const std::vector<RayBench>& models);

}  // namespace mdk
