// Parts that move rigidly, or by any one affine map, stay whole: boxes alone would cut a round one
// into flat pieces, each in axes of its own, and every ray that comes near would enter all of them.
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "common/base/parallel.h"
#include "preprocess/cluster/boxes/box_clusters.h"

namespace mdk {
namespace {

constexpr float kStill = 1e-5f;  // table units: what is left of motion that is none
constexpr std::size_t kSampledTriangles = 32;
constexpr std::size_t kMinTriangles = 8;  // fewer are no part: any map explains a triangle or two
constexpr std::size_t kMaxMotions = 256;  // that parts are compared with

struct ByPlace {
  bool operator()(const std::array<Vec3f, 3>& a, const std::array<Vec3f, 3>& b) const {
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        if (a[i][axis] != b[i][axis]) return a[i][axis] < b[i][axis];
    return false;
  }
};

/// For each vertex the first one that stands where it does in three rows, which may be itself:
/// meshes with sharp edges have a vertex for each side of them.
std::vector<std::uint32_t> welded(const PoseTable& table) {
  const std::uint32_t rows[] = {0, table.row_count() / 2, table.row_count() - 1};
  std::map<std::array<Vec3f, 3>, std::uint32_t, ByPlace> first;
  std::vector<std::uint32_t> same(table.vertex_count);
  for (std::uint32_t v = 0; v < table.vertex_count; ++v) {
    std::array<Vec3f, 3> place;
    for (std::size_t i = 0; i < place.size(); ++i) place[i] = to_float(table.position(rows[i], v));
    same[v] = first.emplace(place, v).first->second;
  }
  return same;
}

/// Triangles by the parts of the mesh that hang together by shared vertices, largest first.
std::vector<std::vector<std::uint32_t>> connected_parts(const MovingMesh& mesh) {
  std::vector<std::uint32_t> root = welded(mesh.poses);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t.v) {
      const std::uint32_t a = find(t.v[0]), b = find(v);
      root[std::max(a, b)] = std::min(a, b);
    }
  std::vector<std::vector<std::uint32_t>> by_root(mesh.poses.vertex_count), parts;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    by_root[find(mesh.triangles[t].v[0])].push_back(t);
  for (std::vector<std::uint32_t>& part : by_root)
    if (part.size() >= kMinTriangles) parts.push_back(std::move(part));
  std::stable_sort(parts.begin(), parts.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return parts;
}

ClusterPoints points_of(const MovingMesh& mesh, std::span<const std::uint32_t> triangles) {
  std::vector<Triangle> chosen;
  for (const std::uint32_t t : triangles) chosen.push_back(mesh.triangles[t]);
  return gather_points(
      mesh.poses, make_cluster_members(chosen, one_cluster(chosen.size()), mesh.poses.vertex_count),
      0);
}

std::vector<std::uint32_t> some_of(std::span<const std::uint32_t> triangles) {
  std::vector<std::uint32_t> some;
  const std::size_t step = (triangles.size() + kSampledTriangles - 1) / kSampledTriangles;
  for (std::size_t i = 0; i < triangles.size(); i += step) some.push_back(triangles[i]);
  return some;
}

/// Whether these maps, from table coordinates, hold all points still.
bool holds_still(const ClusterPoints& points, std::span<const Affine3d> from_table) {
  const PointBoxes boxes = mapped_boxes(points, from_centered(points, from_table));
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < points.vertex_count; ++i)
      if (!(boxes.hi[axis][i] - boxes.lo[axis][i] <= kStill)) return false;
  return true;
}

/// Maps that hold the points still, or none.
std::vector<Affine3d> still_maps(const ClusterPoints& points) {
  std::vector<Affine3d> maps =
      from_table(points, fit_points(points, row_targets(points, 0), points.weights).maps);
  if (!holds_still(points, maps)) maps.clear();
  return maps;
}

/// What the boxes of some triangles cost in a cluster's basis.
double area_in(const BoxCluster& cluster, const ClusterPoints& points) {
  return face_sums(points, mapped_boxes(points, from_centered(points, cluster.maps)))
      .area(cluster.work.weights);
}

}  // namespace

std::vector<std::vector<std::uint32_t>> find_rigid_parts(const MovingMesh& mesh) {
  struct Part {
    std::vector<std::uint32_t> triangles;
    std::vector<Affine3d> maps;
  };
  std::vector<Part> rigid;
  for (std::vector<std::uint32_t>& triangles : connected_parts(mesh)) {
    const std::vector<std::uint32_t> some = some_of(triangles);
    const ClusterPoints sample = points_of(mesh, some);
    std::vector<Affine3d> maps = still_maps(sample);
    if (maps.empty()) continue;
    const ClusterPoints all = points_of(mesh, triangles);
    if (some.size() < triangles.size() && (maps = still_maps(all)).empty()) continue;
    const auto end =
        rigid.begin() + static_cast<std::ptrdiff_t>(std::min(rigid.size(), kMaxMotions));
    const auto same = std::find_if(rigid.begin(), end, [&](const Part& part) {
      return holds_still(sample, part.maps) && holds_still(all, part.maps);
    });
    if (same == end) {
      rigid.push_back({std::move(triangles), std::move(maps)});
    } else {
      same->triangles.insert(same->triangles.end(), triangles.begin(), triangles.end());
    }
  }
  std::vector<std::vector<std::uint32_t>> parts;
  for (Part& part : rigid) parts.push_back(std::move(part.triangles));
  return parts;
}

BoxClustering with_whole_parts(const BoxProblem& problem, BoxClustering clustering,
                               std::span<const std::vector<std::uint32_t>> parts) {
  std::vector<std::uint32_t> assignment = clustering.cluster_of_triangle;
  for (const std::vector<std::uint32_t>& part : parts) {
    std::vector<std::uint32_t> holders;
    for (const std::uint32_t t : part) holders.push_back(assignment[t]);
    holders = sorted_unique(std::move(holders));
    if (holders.size() < 2) continue;
    const ClusterPoints points = points_of(problem.mesh, part);
    std::uint32_t best = holders[0];
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t c : holders) {
      const double area = area_in(clustering.clusters[c], points);
      if (!(area < least)) continue;
      least = area;
      best = c;
    }
    for (const std::uint32_t t : part) assignment[t] = best;
  }
  if (assignment == clustering.cluster_of_triangle) return clustering;
  return fit_boxes(problem, std::move(assignment));
}

}  // namespace mdk
