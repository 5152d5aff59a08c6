#include "common/motion/posed_mesh.h"

#include <limits>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/math/affine_path.h"

namespace mdk {
namespace {

constexpr std::size_t kVerticesPerChunk = 16384;
constexpr std::size_t kDecodedPerChunk = 2048;
constexpr std::size_t kTrianglesPerChunk = 8192;
constexpr Aabb kNowhere{{0, 0, 0}, {0, 0, 0}};

/// Neither empty (corners that are not numbers) nor reaching to infinity.
bool is_usable(const Aabb& b) {
  constexpr float kMax = std::numeric_limits<float>::max();
  bool ok = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ok &= -kMax <= b.lo[axis] && b.lo[axis] <= b.hi[axis] && b.hi[axis] <= kMax;
  }
  return ok;
}

}  // namespace

std::span<const Vec3f> PosedMesh::key_pose(std::uint32_t key, std::uint32_t kept) {
  const std::uint32_t vertices = model_->vertex_count;
  if (model_->poses.kind == PoseKind::kKeyPositions)
    return model_->poses.key_positions.subspan(static_cast<std::size_t>(key) * vertices, vertices);
  for (const DecodedKey& decoded : decoded_)
    if (decoded.key == key) return decoded.positions;
  DecodedKey& slot = decoded_[0].key == kept ? decoded_[1] : decoded_[0];
  slot.key = key;
  slot.positions.resize(vertices);
  parallel_chunks(vertices, kDecodedPerChunk, [&](std::size_t begin, std::size_t end) {
    const VertexRange range{static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    decode_pose(*model_, key, range, std::span(slot.positions).subspan(begin, end - begin));
  });
  return slot.positions;
}

void PosedMesh::set_time(const KeyInterval& at) {
  at_ = at;
  live_clusters_.clear();
  const std::span<const Vec3f> from = key_pose(at.key0, at.key1);
  if (at.s == 0.0f || at.key0 == at.key1) {
    positions_ = from;
    return;
  }
  const std::span<const Vec3f> to = key_pose(at.key1, at.key0);
  between_.resize(from.size());
  parallel_chunks(from.size(), kVerticesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) between_[i] = from[i] + (to[i] - from[i]) * at.s;
  });
  positions_ = between_;
}

void PosedMesh::set_pose(const SkeletonPose& pose) {
  const Model& m = *model_;
  const std::size_t targets = m.poses.rig.target_weights.size() / m.key_count();
  if (m.skeleton.joints.empty())
    throw Error(ErrorCode::kUsage,
                "the model has no skeleton to pose: bake it with --decompose bones --sampling "
                "pose-space");
  if (pose.turns.size() != m.skeleton.joints.size() || pose.target_weights.size() != targets)
    throw Error(ErrorCode::kUsage, "the pose belongs to another skeleton");
  const std::vector<Affine3f> bones = bone_maps(m.skeleton, pose);
  between_.resize(m.vertex_count);
  parallel_chunks(between_.size(), kDecodedPerChunk, [&](std::size_t begin, std::size_t end) {
    const VertexRange range{static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    pose_vertices(m.poses.rig, {bones, pose.target_weights}, range,
                  std::span(between_).subspan(begin, end - begin));
  });
  positions_ = between_;
  live_clusters_.resize(m.clusters.size());
  parallel_chunks(live_clusters_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const ClusterBone& follows = m.cluster_bones[c];
      Aabb box;
      for (const Triangle& triangle :
           m.triangles.subspan(m.clusters[c].first_triangle, m.clusters[c].triangle_count))
        for (const std::uint32_t v : triangle.v) box.extend(between_[v]);
      live_clusters_[c] = {
          to_double(follows.local_from_base) * inverse(to_double(bones[follows.bone])),
          is_usable(box) ? box : kNowhere};
    }
  });
}

Affine3d PosedMesh::cluster_map(std::uint32_t c) const {
  if (is_live()) return live_clusters_[c].local_from_world;
  return interpolate(model_->key_maps(at_.key0)[c], model_->key_maps(at_.key1)[c], at_.s);
}

Aabb PosedMesh::cluster_box(std::uint32_t c) const {
  return is_live() ? live_clusters_[c].box : cluster_world_box(*model_, c, at_);
}

Aabb cluster_world_box(const Model& model, std::uint32_t c, const KeyInterval& at) {
  const Aabb& from = model.key_world_boxes(at.key0)[c];
  if (at.s == 0.0f || at.key0 == at.key1) return from;
  const Aabb& to = model.key_world_boxes(at.key1)[c];
  const double s = at.s;
  const auto lerp = [s](const Vec3f& a, const Vec3f& b) {
    const Vec3d from_d = to_double(a);
    return from_d + (to_double(b) - from_d) * s;
  };
  return round_outward(Aabbd{lerp(from.lo, to.lo), lerp(from.hi, to.hi)});
}

void triangle_boxes(const PosedMesh& mesh, std::span<Aabb> boxes) {
  const std::span<const Triangle> triangles = mesh.model().triangles;
  const std::span<const Vec3f> positions = mesh.positions();
  // Files may hold any positions, NaN included; structures are built over finite boxes.
  parallel_chunks(triangles.size(), kTrianglesPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Aabb box;
      for (std::uint32_t v : triangles[i].v) box.extend(positions[v]);
      boxes[i] = is_usable(box) ? box : kNowhere;
    }
  });
}

}  // namespace mdk
