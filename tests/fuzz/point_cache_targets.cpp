// Point caches of a mesh of four vertices: .pc2 and .mdd.
#include <cmath>
#include <stdexcept>

#include "formats/mesh/point_cache.h"
#include "tests/formats/point_cache_builder.h"
#include "tests/fuzz/fuzz_target.h"

namespace mdk::test {
namespace {

constexpr std::uint32_t kVertices = 4;
constexpr std::uint32_t kFrames = 3;

void read_cache(std::span<const unsigned char> bytes) {
  static FuzzFile file("cache");
  SilentProgress silent;
  const PointCache cache = read_point_cache(file.holding(bytes), {24, kVertices}, silent);
  if (cache.positions.size() != cache.key_times.size() * kVertices)
    throw std::logic_error("read more or fewer positions than keys need");
  for (std::size_t i = 1; i < cache.key_times.size(); ++i)
    if (!(cache.key_times[i] > cache.key_times[i - 1]))
      throw std::logic_error("read falling times");
}

std::vector<Vec3f> points() {
  std::vector<Vec3f> all;
  for (std::uint32_t i = 0; i < kFrames * kVertices; ++i)
    all.push_back({static_cast<float>(i), 0.5f, static_cast<float>(i % kVertices)});
  return all;
}

}  // namespace

const FuzzTarget& pc2_target() {
  static const FuzzTarget target = {
      "pc2", read_cache, [] {
        return std::vector<Bytes>{pc2_bytes(kFrames, points()), pc2_bytes(1, {4, Vec3f{}})};
      }};
  return target;
}

const FuzzTarget& mdd_target() {
  static const FuzzTarget target = {
      "mdd", read_cache, [] {
        return std::vector<Bytes>{mdd_bytes({0, 0.5f, 2}, points()), mdd_bytes({3}, {4, Vec3f{}})};
      }};
  return target;
}

}  // namespace mdk::test
