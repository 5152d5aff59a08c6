#include "preprocess/pose_table.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "common/base/parallel.h"
#include "common/math/aabb.h"

namespace mdk {
namespace {

double largest_extent(std::span<const Vec3f> pose) {
  Aabbd box;
  for (const Vec3f& v : pose) box.extend(to_double(v));
  const Vec3d e = box.extent();
  return box.empty() ? 0 : std::max({e.x, e.y, e.z});
}

Vec3d mean_position(std::span<const Vec3f> pose) {
  Vec3d sum;
  for (const Vec3f& v : pose) sum += to_double(v);
  return pose.empty() ? sum : sum * (1.0 / static_cast<double>(pose.size()));
}

}  // namespace

double pose_unit(const PoseSequence& sequence) {
  std::vector<double> extents(sequence.key_count());
  parallel_chunks(extents.size(), 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      extents[k] = largest_extent(sequence.pose(static_cast<std::uint32_t>(k)));
  });
  const double extent = extents.empty() ? 0 : *std::max_element(extents.begin(), extents.end());
  return extent > 0 ? std::exp2(std::ceil(std::log2(extent))) : 1.0;
}

PoseTable make_pose_table(const PoseSequence& sequence, std::span<const std::uint32_t> keys,
                          double unit) {
  PoseTable table;
  table.vertex_count = sequence.vertex_count;
  table.unit = unit;
  table.keys.assign(keys.begin(), keys.end());
  table.centers.resize(keys.size());
  const std::size_t entries = keys.size() * static_cast<std::size_t>(sequence.vertex_count);
  table.x.resize(entries);
  table.y.resize(entries);
  table.z.resize(entries);

  const double per_unit = 1 / unit;
  parallel_chunks(keys.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      const std::span<const Vec3f> pose = sequence.pose(table.keys[row]);
      const Vec3d center = mean_position(pose);
      table.centers[row] = center;
      std::size_t at = table.row_offset(static_cast<std::uint32_t>(row));
      for (const Vec3f& v : pose) {
        const Vec3f p = to_float((to_double(v) - center) * per_unit);
        table.x[at] = p.x;
        table.y[at] = p.y;
        table.z[at] = p.z;
        ++at;
      }
    }
  });
  return table;
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
