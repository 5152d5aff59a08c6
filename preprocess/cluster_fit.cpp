#include "preprocess/cluster_fit.h"

#include <algorithm>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr std::size_t kRowsPerChunk = 8;
constexpr std::size_t kVertexBlock = 256;

AffineFit fit_row(const PoseTable& table, const ClusterMembers& members, std::uint32_t cluster,
                  std::uint32_t row, std::uint32_t rest_row) {
  MomentSum sum;
  for (std::uint32_t s = members.vertex_begin[cluster]; s < members.vertex_begin[cluster + 1]; ++s)
    sum.add(table.position(row, members.vertices[s]), table.position(rest_row, members.vertices[s]),
            members.uses[s]);
  return fit_affine(sum.moments(), table_fit_options());
}

/// acc[i] += |m (x, y, z)[i] - rest[i]|^2 over one block of vertices of one row.
void add_block_residuals(const Affine3<float>& m, const float* __restrict x,
                         const float* __restrict y, const float* __restrict z,
                         const float* __restrict rx, const float* __restrict ry,
                         const float* __restrict rz, float* __restrict acc, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) {
    const float dx = m.m[0][0] * x[i] + m.m[0][1] * y[i] + m.m[0][2] * z[i] + (m.m[0][3] - rx[i]);
    const float dy = m.m[1][0] * x[i] + m.m[1][1] * y[i] + m.m[1][2] * z[i] + (m.m[1][3] - ry[i]);
    const float dz = m.m[2][0] * x[i] + m.m[2][1] * y[i] + m.m[2][2] * z[i] + (m.m[2][3] - rz[i]);
    acc[i] += dx * dx + dy * dy + dz * dz;
  }
}

}  // namespace

FitOptions table_fit_options() {
  FitOptions options;
  options.noise = 1e-7;
  return options;
}

ClusterMaps fit_clusters(const PoseTable& table, const ClusterMembers& members,
                         std::uint32_t rest_row) {
  ClusterMaps result;
  result.row_count = table.row_count();
  const std::size_t fits = static_cast<std::size_t>(members.cluster_count()) * table.row_count();
  result.maps.resize(fits);
  result.residuals.resize(fits);
  parallel_chunks(fits, kRowsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const AffineFit fit =
          fit_row(table, members, static_cast<std::uint32_t>(i / table.row_count()),
                  static_cast<std::uint32_t>(i % table.row_count()), rest_row);
      result.maps[i] = fit.target_from_source;
      result.residuals[i] = fit.residual;
    }
  });
  return result;
}

ClusterMaps fit_triangles(const PoseTable& table, std::span<const Triangle> triangles,
                          std::span<const std::uint32_t> chosen, std::uint32_t rest_row) {
  ClusterMaps result;
  result.row_count = table.row_count();
  result.maps.resize(table.row_count());
  result.residuals.resize(table.row_count());
  parallel_chunks(table.row_count(), kRowsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      MomentSum sum;
      for (const std::uint32_t t : chosen)
        for (const std::uint32_t v : triangles[t].v)
          sum.add(table.position(static_cast<std::uint32_t>(row), v), table.position(rest_row, v),
                  1);
      const AffineFit fit = fit_affine(sum.moments(), table_fit_options());
      result.maps[row] = fit.target_from_source;
      result.residuals[row] = fit.residual;
    }
  });
  return result;
}

void vertex_residuals(const PoseTable& table, std::uint32_t rest_row,
                      std::span<const Affine3d> maps, std::span<float> out) {
  const std::size_t rows = table.row_count(), clusters = maps.size() / rows;
  std::vector<Affine3f> narrow(maps.size());
  std::transform(maps.begin(), maps.end(), narrow.begin(),
                 [](const Affine3d& m) { return to_float(m); });
  parallel_chunks(table.vertex_count, kVertexBlock, [&](std::size_t begin, std::size_t end) {
    // Row by row over all clusters, so that a row's block is read from the first cache.
    std::vector<float> acc(clusters * kVertexBlock, 0.0f);
    const std::size_t rest = table.row_offset(rest_row) + begin;
    for (std::size_t row = 0; row < rows; ++row) {
      const std::size_t at = table.row_offset(static_cast<std::uint32_t>(row)) + begin;
      for (std::size_t c = 0; c < clusters; ++c)
        add_block_residuals(narrow[c * rows + row], &table.x[at], &table.y[at], &table.z[at],
                            &table.x[rest], &table.y[rest], &table.z[rest], &acc[c * kVertexBlock],
                            end - begin);
    }
    for (std::size_t c = 0; c < clusters; ++c)
      std::copy_n(&acc[c * kVertexBlock], end - begin, &out[c * table.vertex_count + begin]);
  });
}

}  // namespace mdk
