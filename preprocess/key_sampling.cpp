#include "preprocess/key_sampling.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

#include "common/base/parallel.h"

namespace mdk {
namespace {

/// Centred coordinates of the sampled vertices, one row per key.
struct PosePoints {
  std::size_t width = 0;
  std::vector<float> values;

  const float* row(std::size_t key) const { return &values[key * width]; }
};

PosePoints gather_points(const PoseSequence& sequence, std::uint32_t max_points) {
  const std::size_t step =
      (sequence.vertex_count + max_points - 1) / std::max<std::size_t>(1, max_points);
  const std::size_t points = (sequence.vertex_count + step - 1) / step;
  PosePoints result;
  result.width = 3 * points;
  result.values.resize(result.width * sequence.key_count());
  parallel_chunks(sequence.key_count(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t key = begin; key < end; ++key) {
      const std::span<const Vec3f> pose = sequence.pose(static_cast<std::uint32_t>(key));
      Vec3d center;
      for (std::size_t i = 0; i < points; ++i) center += to_double(pose[i * step]);
      center = center * (1.0 / static_cast<double>(points));
      float* out = &result.values[key * result.width];
      for (std::size_t i = 0; i < points; ++i) {
        const Vec3f p = to_float(to_double(pose[i * step]) - center);
        out[3 * i] = p.x;
        out[3 * i + 1] = p.y;
        out[3 * i + 2] = p.z;
      }
    }
  });
  return result;
}

double squared_distance(const float* a, const float* b, std::size_t n) {
  double lanes[4] = {};  // independent sums, so that the loop is not one long chain of additions
  std::size_t i = 0;
  for (; i + 4 <= n; i += 4)
    for (std::size_t j = 0; j < 4; ++j) {
      const double d = static_cast<double>(a[i + j]) - b[i + j];
      lanes[j] += d * d;
    }
  for (; i < n; ++i) {
    const double d = static_cast<double>(a[i]) - b[i];
    lanes[0] += d * d;
  }
  return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

std::vector<float> mean_row(const PosePoints& points, std::size_t keys) {
  std::vector<double> sum(points.width, 0);
  for (std::size_t key = 0; key < keys; ++key)
    for (std::size_t i = 0; i < points.width; ++i) sum[i] += points.row(key)[i];
  std::vector<float> mean(points.width);
  for (std::size_t i = 0; i < points.width; ++i)
    mean[i] = static_cast<float>(sum[i] / static_cast<double>(keys));
  return mean;
}

}  // namespace

std::vector<std::uint32_t> sample_keys(const PoseSequence& sequence,
                                       const KeySamplingOptions& options) {
  const std::size_t keys = sequence.key_count();
  std::vector<std::uint32_t> chosen;
  if (options.count >= keys) {
    chosen.resize(keys);
    std::iota(chosen.begin(), chosen.end(), 0u);
    return chosen;
  }
  const PosePoints points = gather_points(sequence, options.max_points);
  const std::vector<float> mean = mean_row(points, keys);
  std::vector<double> distance(keys);  // to the chosen keys; at first to the mean pose
  for (std::size_t k = 0; k < keys; ++k)
    distance[k] = squared_distance(points.row(k), mean.data(), points.width);
  while (chosen.size() < options.count) {
    const std::size_t next = static_cast<std::size_t>(
        std::max_element(distance.begin(), distance.end()) - distance.begin());
    if (!chosen.empty() && !(distance[next] > 0)) break;
    if (chosen.empty())
      std::fill(distance.begin(), distance.end(), std::numeric_limits<double>::infinity());
    chosen.push_back(static_cast<std::uint32_t>(next));
    parallel_chunks(keys, 32, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        distance[k] =
            std::min(distance[k], squared_distance(points.row(k), points.row(next), points.width));
    });
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace mdk
