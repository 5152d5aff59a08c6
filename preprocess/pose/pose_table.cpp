#include "preprocess/pose/pose_table.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr std::size_t kSampledVertices = 2048;  // that distances of poses are taken over

double largest_extent(std::span<const Vec3f> pose) {
  const Aabbd box = pose_box(pose);
  const Vec3d e = box.extent();
  return box.empty() ? 0 : std::max({e.x, e.y, e.z});
}

Vec3d mean_position(std::span<const Vec3f> pose) {
  Vec3d sum;
  for (const Vec3f& v : pose) sum += to_double(v);
  return pose.empty() ? sum : sum * (1.0 / static_cast<double>(pose.size()));
}

/// Centred coordinates of the sampled vertices, one row per key.
struct PosePoints {
  std::size_t width = 0;
  std::vector<float> values;

  const float* row(std::size_t key) const { return &values[key * width]; }
};

PosePoints gather_points(const PoseSequence& sequence) {
  const std::size_t step = (sequence.vertex_count + kSampledVertices - 1) / kSampledVertices;
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

PointArrays PointArrays::part(std::size_t begin, std::size_t count) const {
  const auto copy = [&](const ScratchList<float>& from, ScratchList<float>& to) {
    const auto first = from.begin() + static_cast<std::ptrdiff_t>(begin);
    to.assign(first, first + static_cast<std::ptrdiff_t>(count));
  };
  PointArrays result;
  copy(x, result.x);
  copy(y, result.y);
  copy(z, result.z);
  return result;
}

Aabbd pose_box(std::span<const Vec3f> pose) {
  Aabbd box;
  for (const Vec3f& v : pose) box.extend(to_double(v));
  return box;
}

std::vector<double> pose_box_areas(const PoseSequence& sequence) {
  std::vector<double> areas(sequence.key_count());
  parallel_chunks(areas.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t key = begin; key < end; ++key)
      areas[key] = surface_area(pose_box(sequence.pose(static_cast<std::uint32_t>(key))));
  });
  return areas;
}

std::vector<double> row_box_areas(const PoseTable& table) {
  std::vector<double> areas(table.row_count());
  parallel_chunks(areas.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      Aabbd box;
      for (std::uint32_t v = 0; v < table.vertex_count; ++v)
        box.extend(table.position(static_cast<std::uint32_t>(row), v));
      areas[row] = surface_area(box);
    }
  });
  return areas;
}

double pose_unit(const PoseSequence& sequence) {
  std::vector<double> extents(sequence.key_count());
  parallel_chunks(extents.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      extents[k] = largest_extent(sequence.pose(static_cast<std::uint32_t>(k)));
  });
  const double extent = extents.empty() ? 0 : *std::max_element(extents.begin(), extents.end());
  return extent > 0 ? std::exp2(std::ceil(std::log2(extent))) : 1.0;
}

std::vector<std::uint32_t> sample_keys(const PoseSequence& sequence, std::size_t count) {
  const std::size_t keys = sequence.key_count();
  std::vector<std::uint32_t> chosen;
  if (count >= keys) {
    chosen.resize(keys);
    std::iota(chosen.begin(), chosen.end(), 0u);
    return chosen;
  }
  const PosePoints points = gather_points(sequence);
  const std::vector<float> mean = mean_row(points, keys);
  std::vector<double> distance(keys);  // to the chosen keys; at first to the mean pose
  for (std::size_t k = 0; k < keys; ++k)
    distance[k] = squared_distance(points.row(k), mean.data(), points.width);
  while (chosen.size() < count) {
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

PoseTable make_pose_table(const PoseSequence& sequence, std::span<const std::uint32_t> keys,
                          double unit) {
  PoseTable table;
  table.vertex_count = sequence.vertex_count;
  table.unit = unit;
  table.keys.assign(keys.begin(), keys.end());
  table.centers.resize(keys.size());
  table.resize(keys.size() * static_cast<std::size_t>(sequence.vertex_count));

  const double per_unit = 1 / unit;
  parallel_chunks(keys.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::span<const Vec3f> pose = sequence.pose(table.keys[row]);
      const Vec3d center = mean_position(pose);
      table.centers[row] = center;
      std::size_t at = table.row_offset(static_cast<std::uint32_t>(row));
      for (const Vec3f& v : pose) table.set(at++, to_float((to_double(v) - center) * per_unit));
    }
  });
  return table;
}

PoseTable sample_poses(const PoseSequence& sequence, std::size_t count,
                       std::span<const std::uint32_t> also, double unit) {
  std::vector<std::uint32_t> keys = sample_keys(sequence, count);
  for (const std::uint32_t key : also)
    if (const auto at = std::lower_bound(keys.begin(), keys.end(), key);
        at == keys.end() || *at != key)
      keys.insert(at, key);
  return make_pose_table(sequence, keys, unit);
}

PointArrays gather_vertices(const PoseTable& table, std::span<const std::uint32_t> vertices) {
  PointArrays gathered;
  gathered.resize(vertices.size() * table.row_count());
  std::size_t to = 0;
  for (std::uint32_t row = 0; row < table.row_count(); ++row)
    for (const std::uint32_t v : vertices) {
      const std::size_t i = table.row_offset(row) + v;
      gathered.set(to++, {table.x[i], table.y[i], table.z[i]});
    }
  return gathered;
}

std::uint32_t row_of_key(const PoseTable& table, std::uint32_t key) {
  const auto found = std::find(table.keys.begin(), table.keys.end(), key);
  assert(found != table.keys.end());
  return static_cast<std::uint32_t>(found - table.keys.begin());
}

Affine3d world_map(const PoseTable& table, std::uint32_t row, const Affine3d& from_row) {
  Affine3d map = from_row;
  const Vec3d shift = map.vector(table.centers[row]);
  for (int i = 0; i < 3; ++i)
    map.m[i][3] = table.unit * from_row.m[i][3] - shift[static_cast<std::size_t>(i)];
  return map;
}

}  // namespace mdk
