// Bones as clusters (GFSS06; Lo09 §4.3): a cluster's basis is a bone's, A_c(t) = bone⁻¹(t), and a
// triangle goes to the bone in whose basis its fuzzy box is smallest. Over clips all bones are
// tried, most of them ruled out by their boxes over a few keys; over a pose space those that move
// one of its corners. Parts that move rigidly are bones, too (common/motion/rig.h).
#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

#include "common/base/parallel.h"
#include "preprocess/boxes/cost.h"
#include "preprocess/cluster/boxes/box_clusters.h"
#include "preprocess/cluster/clusters.h"
#include "preprocess/cluster/common_moves.h"
#include "preprocess/maps/key_maps.h"
#include "preprocess/pose/pose_table.h"

namespace mdk {
namespace {

constexpr std::uint32_t kNobody = std::numeric_limits<std::uint32_t>::max();

/// The bones that move a corner of a triangle, each once, rising.
std::vector<std::uint32_t> bones_of(const Rig& rig, const Triangle& triangle) {
  std::vector<std::uint32_t> bones;
  for (const std::uint32_t v : triangle.v)
    for (std::uint32_t i = rig.first_weight[v]; i < rig.first_weight[v + 1]; ++i)
      bones.push_back(rig.bone_weights[i].bone);
  return sorted_unique(std::move(bones));
}

/// What one bone would make of the triangles it could take.
struct Offer {
  std::vector<std::uint32_t> triangles;
  std::vector<double> areas;  ///< of their fuzzy boxes; infinite where it has none for them
};

struct Candidates {
  const PoseSequence& sequence;
  std::span<const std::uint32_t> keys;
  std::span<const double> model_areas;  ///< beside `keys`
  const PoseSpace& space;
};

/// Boxes of the vertices in the bone's base space.
std::vector<Aabbd> vertex_boxes(const Candidates& c, std::uint32_t bone,
                                std::span<const Affine3d> maps,
                                std::span<const std::uint32_t> vertices) {
  std::vector<Aabbd> boxes(vertices.size());
  for (std::size_t k = 0; k < c.keys.size(); ++k) {
    const std::span<const Vec3f> pose = c.sequence.pose(c.keys[k]);
    for (std::size_t i = 0; i < vertices.size(); ++i)
      boxes[i].extend(maps[k].point(to_double(pose[vertices[i]])));
  }
  BoneSpace space(c.space, bone);
  if (!space.is_usable()) return {};
  for (std::size_t i = 0; i < vertices.size(); ++i)
    boxes[i].extend(space.vertex_box(vertices[i], {}));
  return boxes;
}

void judge(const Candidates& c, std::uint32_t bone, Offer& offer) {
  offer.areas.assign(offer.triangles.size(), std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t t : offer.triangles)
    vertices.insert(vertices.end(), std::begin(c.sequence.triangles[t].v),
                    std::end(c.sequence.triangles[t].v));
  vertices = sorted_unique(std::move(vertices));
  const std::vector<Affine3d> maps =
      base_from_world(*c.sequence.rig, bone, c.keys, c.sequence.key_count());
  const std::vector<Aabbd> boxes = vertex_boxes(c, bone, maps, vertices);
  if (boxes.empty()) return;
  const AreaWeights weights = mean_area_weights(maps, c.model_areas);
  for (std::size_t i = 0; i < offer.triangles.size(); ++i) {
    Aabbd box;
    for (const std::uint32_t v : c.sequence.triangles[offer.triangles[i]].v)
      box.extend(boxes[static_cast<std::size_t>(
          std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin())]);
    offer.areas[i] = weights.area(box.extent());
  }
}

BoneClusters numbered(std::vector<std::uint32_t> bone_of_triangle) {
  BoneClusters result{{}, sorted_unique(bone_of_triangle)};
  static_cast<Assignment&>(result) = make_assignment(std::move(bone_of_triangle));
  return result;
}

/// Of the bones that move one of its corners.
std::vector<std::uint32_t> best_in_space(const PoseSequence& sequence,
                                         std::span<const std::uint32_t> keys,
                                         std::size_t bone_count, const PoseSpace& space) {
  std::vector<Offer> offers(bone_count);
  for (std::uint32_t t = 0; t < sequence.triangles.size(); ++t)
    for (const std::uint32_t bone : bones_of(*sequence.rig, sequence.triangles[t]))
      offers[bone].triangles.push_back(t);
  std::vector<double> areas;
  for (const std::uint32_t key : keys) areas.push_back(surface_area(pose_box(sequence.pose(key))));
  const Candidates candidates{sequence, keys, areas, space};
  parallel_chunks(bone_count, 1, [&](std::size_t bone, std::size_t) {
    if (!offers[bone].triangles.empty())
      judge(candidates, static_cast<std::uint32_t>(bone), offers[bone]);
  });

  std::vector<double> least(sequence.triangles.size(), std::numeric_limits<double>::infinity());
  std::vector<std::uint32_t> owner(sequence.triangles.size(), kNobody);
  for (std::uint32_t bone = 0; bone < bone_count; ++bone)
    for (std::size_t i = 0; i < offers[bone].triangles.size(); ++i) {
      const std::uint32_t t = offers[bone].triangles[i];
      if (owner[t] != kNobody && !(offers[bone].areas[i] < least[t])) continue;
      owner[t] = bone;
      least[t] = offers[bone].areas[i];
    }
  return owner;
}

}  // namespace

BoneClusters assign_to_bones(const PoseSequence& sequence, const PoseTable& table,
                             const PoseSpace* space) {
  const std::size_t bone_count = sequence.rig->bone_maps.size() / sequence.key_count();
  if (space != nullptr) return numbered(best_in_space(sequence, table.keys, bone_count, *space));
  const BoxProblem problem{{table, sequence.triangles}, {0, row_box_areas(table), 1}};
  std::vector<BoxCluster> bones(bone_count);
  parallel_chunks(bone_count, 1, [&](std::size_t bone, std::size_t) {
    bones[bone].maps = base_from_table(*sequence.rig, static_cast<std::uint32_t>(bone), table,
                                       sequence.key_count());
    bones[bone].work.weights = mean_area_weights(bones[bone].maps, problem.measure.model_areas);
  });
  return numbered(assign_to_smallest_boxes(problem, std::move(bones)));
}

}  // namespace mdk
