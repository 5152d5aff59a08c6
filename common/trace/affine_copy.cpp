#include "common/trace/affine_copy.h"

#include <cmath>
#include <limits>
#include <span>

#include "common/base/parallel.h"
#include "common/math/affine3.h"

namespace mdk {

AffineCopy::AffineCopy(const ModelView& model)
    : triangles_(model.triangles.begin(), model.triangles.end()),
      maps_(model.clusters.size()),
      cluster_boxes_(model.clusters.size()),
      clips_{{"", 0, 1}} {
  constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
  std::vector<Vec3f> rest(model.vertex_count);
  decode_pose(model, model.rest_key, {0, model.vertex_count}, rest);
  std::vector<std::uint32_t> number(model.vertex_count, kUnused), used;
  for (std::size_t c = 0; c < model.clusters.size(); ++c) {
    const Affine3d map = to_double(model.key_maps(model.rest_key)[c]);
    const Cluster& cluster = model.clusters[c];
    first_vertex_.push_back(static_cast<std::uint32_t>(local_.size()));
    for (Triangle& t :
         std::span(triangles_).subspan(cluster.first_triangle, cluster.triangle_count))
      for (std::uint32_t& v : t.v) {
        if (number[v] == kUnused) {
          number[v] = static_cast<std::uint32_t>(local_.size());
          used.push_back(v);
          local_.push_back(map.point(to_double(rest[v])));
        }
        v = number[v];
      }
    for (const std::uint32_t v : used) number[v] = kUnused;
    used.clear();
  }
  first_vertex_.push_back(static_cast<std::uint32_t>(local_.size()));
  positions_.resize(local_.size());

  copy_.vertex_count = static_cast<std::uint32_t>(local_.size());
  copy_.rest_diagonal = model.rest_diagonal;
  copy_.clips = clips_;
  copy_.key_times = {&time_, 1};
  copy_.poses.key_positions = positions_;
  copy_.triangles = triangles_;
  copy_.source_triangles = model.source_triangles;
  copy_.clusters = model.clusters;
  copy_.local_from_world = maps_;
  copy_.key_boxes = {&box_, 1};
  copy_.cluster_world_boxes = cluster_boxes_;
  copy_.segments = {&segment_, 1};
  copy_.appearance = model.appearance;
}

const ModelView& AffineCopy::at(const PosedMesh& mesh) {
  parallel_chunks(maps_.size(), 1, [&](std::size_t c, std::size_t) {
    const Affine3d world_from_local = inverse(mesh.cluster_map(static_cast<std::uint32_t>(c)));
    for (std::uint32_t i = first_vertex_[c]; i < first_vertex_[c + 1]; ++i)
      positions_[i] = to_float(world_from_local.point(local_[i]));
  });
  box_ = {};
  for (const Vec3f& p : positions_)
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) box_.extend(p);
  if (box_.empty()) box_ = {{0, 0, 0}, {0, 0, 0}};
  copy_.bounds = box_;
  return copy_;
}

}  // namespace mdk
