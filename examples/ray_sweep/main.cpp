// ray_sweep FILE.mdk: looks at the model as a lidar does that turns once while the first clip
// plays, every ray at a time of its own, and prints how many hit.
#include <mdk/error.h>
#include <mdk/ray_query.h>

#include <cmath>
#include <iostream>
#include <vector>

namespace {

constexpr int kRays = 3600;
constexpr double kTurn = 6.283185307179586;

struct Sweep {
  std::vector<mdk::QueryRay> rays;
  std::vector<mdk::KeyInterval> times;
};

/// From outside the model's bounds towards its middle, from all sides.
Sweep make_sweep(const mdk::Model& model) {
  const mdk::Vec3f middle = model.bounds().center();
  const mdk::Vec3f size = model.bounds().extent();
  const float radius = std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z);
  const double seconds = model.clip(0).seconds;
  Sweep sweep;
  for (int i = 0; i < kRays; ++i) {
    const double share = static_cast<double>(i) / kRays;
    const auto angle = static_cast<float>(kTurn * share);
    const mdk::Vec3f away{std::cos(angle), 0, std::sin(angle)};
    mdk::QueryRay ray;
    ray.origin = middle + away * radius;
    ray.direction = -away;
    sweep.rays.push_back(ray);
    sweep.times.push_back(model.locate_time(0, seconds * share));
  }
  return sweep;
}

void run(const char* path) {
  const mdk::Model model = mdk::Model::load(path);
  const mdk::RayQuery query(model);
  const Sweep sweep = make_sweep(model);
  std::vector<mdk::QueryHit> hits(sweep.rays.size());
  query.closest_hits(sweep.rays.data(), sweep.times.data(), hits.data(), hits.size());
  int hit_count = 0;
  for (const mdk::QueryHit& hit : hits) hit_count += hit.is_hit() ? 1 : 0;
  std::cout << hit_count << " of " << kRays << " rays hit\n";
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
