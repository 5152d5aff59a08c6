// ray_sweep FILE.mdk: looks at the model as a lidar does that turns once while the first clip
// plays, every ray at a time of its own, and prints what it met.
#include <cmath>
#include <iostream>
#include <numbers>
#include <vector>

#include "common/base/error.h"
#include "common/trace/ray_query.h"
#include "formats/mdk/mdk_file.h"

namespace {

constexpr int kRays = 3600;

struct Sweep {
  std::vector<mdk::QueryRay> rays;
  std::vector<mdk::KeyInterval> times;
};

/// From outside the model's bounds towards its middle, from all sides.
Sweep make_sweep(const mdk::ModelView& model) {
  const mdk::Vec3f middle = (model.bounds.lo + model.bounds.hi) * 0.5f;
  const mdk::Vec3f size = model.bounds.hi - model.bounds.lo;
  const float radius = std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z);
  const double seconds = model.clip_seconds(model.clips.front());
  Sweep sweep;
  for (int i = 0; i < kRays; ++i) {
    const double turn = static_cast<double>(i) / kRays;
    const auto angle = static_cast<float>(2 * std::numbers::pi * turn);
    const mdk::Vec3f away{std::cos(angle), 0, std::sin(angle)};
    sweep.rays.push_back({.origin = middle + away * radius, .direction = away * -1.0f});
    sweep.times.push_back(mdk::locate_time(model, 0, seconds * turn));
  }
  return sweep;
}

void run(const char* path) {
  const mdk::MdkFile file(path);
  const mdk::RayQuery query(file.model());
  const Sweep sweep = make_sweep(file.model());
  std::vector<mdk::QueryHit> hits(sweep.rays.size());
  query.closest_hits(sweep.rays, sweep.times, hits);
  int met = 0;
  for (const mdk::QueryHit& hit : hits) met += std::isfinite(hit.t) ? 1 : 0;
  std::cout << met << " of " << kRays << " rays hit\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: ray_sweep FILE.mdk\n";
    return 2;
  }
  try {
    run(argv[1]);
    return 0;
  } catch (const mdk::Error& error) {
    std::cerr << "ray_sweep: " << error.what() << "\n";
    return error.exit_status();
  }
}
