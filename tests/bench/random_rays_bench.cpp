// What a random ray costs: times rays that hit each model's box as the cost of a decomposition
// counts them (docs/method.md, cost), that is lines without a preferred place or direction, and
// prints a line per file: its name, its clusters, how many of them a ray is expected to enter,
// nanoseconds a ray, and the share of rays that hit.
//
//     random_rays_bench FILE.mdk…
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "common/motion/model_handle.h"
#include "common/motion/posed_mesh.h"
#include "mdk/ray_query.h"

namespace {

constexpr std::uint32_t kKeys = 16;
constexpr int kRays = 10'000, kRounds = 7;

mdk::Aabb box_at(mdk::PosedMesh& mesh, const mdk::KeyInterval& at) {
  mesh.set_time(at);
  mdk::Aabb box;
  for (const mdk::Vec3f& v : mesh.positions()) box.extend(v);
  return box;
}

/// Lines that hit a box, each equally likely (isotropic, uniform): they enter it at a point of a
/// face drawn by area, at an angle drawn by its cosine.
std::vector<mdk::QueryRay> random_lines(const mdk::Aabb& box, std::mt19937_64& engine) {
  std::uniform_real_distribution<float> unit(0, 1);
  const std::array<float, 3> e{box.hi.x - box.lo.x, box.hi.y - box.lo.y, box.hi.z - box.lo.z};
  const std::array<float, 3> sides{e[1] * e[2], e[2] * e[0], e[0] * e[1]};
  std::discrete_distribution<int> side(sides.begin(), sides.end());
  std::vector<mdk::QueryRay> rays;
  for (int i = 0; i < kRays; ++i) {
    const int axis = side(engine);
    const bool from_high = unit(engine) < 0.5f;
    const float out = std::sqrt(unit(engine)), turn = 2 * std::numbers::pi_v<float> * unit(engine);
    std::array<float, 3> origin{}, direction{};
    origin[axis] = from_high ? e[axis] : 0;
    direction[axis] = std::sqrt(std::max(0.0f, 1 - out * out)) * (from_high ? -1.0f : 1.0f);
    for (const int k : {1, 2}) {
      const int other = (axis + k) % 3;
      origin[other] = e[other] * unit(engine);
      direction[other] = out * (k == 1 ? std::cos(turn) : std::sin(turn));
    }
    rays.push_back({.origin = box.lo + mdk::Vec3f{origin[0], origin[1], origin[2]},
                    .direction = {direction[0], direction[1], direction[2]}});
  }
  return rays;
}

/// Clusters whose world boxes a line that hits the model's box is expected to enter.
double clusters_entered(const mdk::ModelView& model, std::uint32_t key, const mdk::Aabb& box) {
  double area = 0;
  for (std::size_t c = 0; c < model.cluster_count(); ++c)
    area += surface_area(model.world_box(key, c));
  return area / surface_area(box);
}

struct Cost {
  double entered = 0;      ///< clusters
  double nanoseconds = 0;  ///< a ray
  double hits = 0;         ///< share of the rays
};

Cost cost_of(const mdk::RayQuery& query, const std::vector<mdk::QueryRay>& rays,
             const mdk::QueryMoment& moment) {
  Cost cost{0, std::numeric_limits<double>::infinity(), 0};
  for (int round = 0; round < kRounds; ++round) {
    int hits = 0;
    const auto start = std::chrono::steady_clock::now();
    for (const mdk::QueryRay& ray : rays) hits += std::isfinite(query.closest_hit(ray, moment).t);
    const std::chrono::duration<double, std::nano> passed =
        std::chrono::steady_clock::now() - start;
    cost.nanoseconds = std::min(cost.nanoseconds, passed.count() / kRays);
    cost.hits = static_cast<double>(hits) / kRays;
  }
  return cost;
}

void measure(const char* path) {
  const mdk::Model loaded = mdk::Model::load(path);
  const mdk::ModelView& model = mdk::ModelHandle::view(loaded);
  const mdk::RayQuery query(loaded);
  mdk::PosedMesh mesh(model);
  std::mt19937_64 engine(1);
  const std::uint32_t keys = std::min(kKeys, model.key_count());
  Cost mean;
  for (std::uint32_t i = 0; i < keys; ++i) {
    const std::uint32_t key = i * model.key_count() / keys;
    const mdk::KeyInterval at = mdk::at_key(key);
    const mdk::Aabb box = box_at(mesh, at);
    const mdk::QueryMoment moment = query.prepare(at);
    const Cost cost = cost_of(query, random_lines(box, engine), moment);
    mean.entered += clusters_entered(model, key, box) / keys;
    mean.nanoseconds += cost.nanoseconds / keys;
    mean.hits += cost.hits / keys;
  }
  std::printf("%s %u %.3f %.1f %.4f\n", std::filesystem::path(path).stem().c_str(),
              model.cluster_count(), mean.entered, mean.nanoseconds, mean.hits);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    for (int i = 1; i < argc; ++i) measure(argv[i]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "random_rays_bench: %s\n", error.what());
    return 1;
  }
}
