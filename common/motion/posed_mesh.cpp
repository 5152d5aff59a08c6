#include "common/motion/posed_mesh.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/stopwatch.h"
#include "common/math/affine3.h"

namespace mdk {
namespace {

constexpr std::size_t kVerticesPerChunk = 16384;
constexpr std::size_t kDecodedPerChunk = 2048;
constexpr std::size_t kTrianglesPerChunk = 8192;
constexpr Aabb kNowhere{{0, 0, 0}, {0, 0, 0}};

constexpr std::uint32_t kNone = 0xffffffffu;

/// Ascending, each once.
void tidy(std::vector<std::uint32_t>& numbers) {
  std::ranges::sort(numbers);
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

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

ClusterVertices::ClusterVertices(const ModelView& model) {
  const std::uint32_t clusters = model.cluster_count();
  std::vector<std::uint32_t> owner(model.vertex_count, kNone), last_user(model.vertex_count, kNone);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> border;  // vertex, cluster that uses it
  std::vector<std::uint32_t> owners;
  for (std::uint32_t c = 0; c < clusters; ++c) {
    const Cluster& cluster = model.clusters[c];
    owners.clear();
    for (const Triangle& t :
         model.triangles.subspan(cluster.first_triangle, cluster.triangle_count))
      for (const std::uint32_t v : t.v) {
        if (last_user[v] == c) continue;
        last_user[v] = c;
        if (owner[v] == kNone) owner[v] = c;
        if (owner[v] != c) border.emplace_back(v, c);
        if (owners.empty() || owners.back() != owner[v]) owners.push_back(owner[v]);
      }
    tidy(owners);
    owners_.items.insert(owners_.items.end(), owners.begin(), owners.end());
    owners_.end_list();
  }

  std::vector<std::vector<VertexRange>> runs(clusters);
  for (std::uint32_t v = 0; v < model.vertex_count; ++v) {
    if (owner[v] == kNone) continue;
    std::vector<VertexRange>& mine = runs[owner[v]];
    if (mine.empty() || mine.back().end != v) mine.push_back({v, v});
    ++mine.back().end;
  }
  for (const std::vector<VertexRange>& mine : runs) {
    owned_.items.insert(owned_.items.end(), mine.begin(), mine.end());
    owned_.end_list();
  }

  std::vector<std::vector<std::uint32_t>> neighbours(clusters);
  std::ranges::sort(border);
  for (std::size_t i = 0; i < border.size();) {
    const std::uint32_t v = border[i].first;
    owners.assign(1, owner[v]);
    for (; i < border.size() && border[i].first == v; ++i) owners.push_back(border[i].second);
    for (const std::uint32_t a : owners)
      neighbours[a].insert(neighbours[a].end(), owners.begin(), owners.end());
  }
  for (std::uint32_t c = 0; c < clusters; ++c) {
    neighbours[c].push_back(c);
    tidy(neighbours[c]);
    around_.items.insert(around_.items.end(), neighbours[c].begin(), neighbours[c].end());
    around_.end_list();
  }
}

PosedMesh::KeyPose PosedMesh::key_pose(std::uint32_t key, std::uint32_t kept) {
  const std::uint32_t vertices = model_->vertex_count;
  if (model_->poses.kind == PoseKind::kKeyPositions) {
    const std::size_t first = static_cast<std::size_t>(key) * vertices;
    return {model_->poses.key_positions.subspan(first, vertices).data(), nullptr};
  }
  for (DecodedKey& decoded : work_->decoded)
    if (decoded.key == key) return {decoded.positions.data(), &decoded};
  auto& [first, second] = work_->decoded;
  DecodedKey& slot = first.key == kept ? second : first;
  slot.key = key;
  slot.positions.resize(vertices);
  slot.owned.begin(model_->cluster_count());
  slot.complete = false;
  return {slot.positions.data(), &slot};
}

void PosedMesh::set_time(const KeyInterval& at) {
  const std::uint32_t vertices = model_->vertex_count;
  at_ = at;
  live_clusters_.clear();
  from_ = key_pose(at.key0, at.key1);
  to_ = {};
  if (at.s == 0.0f || at.key0 == at.key1) {
    positions_ = {from_.positions, vertices};
    work_->complete = from_.decoded == nullptr || from_.decoded->complete;
  } else {
    to_ = key_pose(at.key1, at.key0);
    work_->between.resize(vertices);
    positions_ = work_->between;
    work_->complete = false;
  }
  work_->owned.begin(model_->cluster_count());
  work_->ready.begin(model_->cluster_count());
}

const ClusterVertices& PosedMesh::vertices() const {
  std::call_once(work_->vertices_known, [this] { work_->vertices.emplace(*model_); });
  return *work_->vertices;
}

void PosedMesh::decode_owned(const KeyPose& pose, std::uint32_t c) const {
  if (pose.decoded == nullptr || pose.decoded->complete) return;
  pose.decoded->owned.once(c, [&] {
    for (const VertexRange& run : vertices().owned(c))
      decode_pose(*model_, *pose.decoded->key, run,
                  std::span(pose.decoded->positions).subspan(run.begin, run.size()));
  });
}

void PosedMesh::move_between(const VertexRange& range) const {
  for (std::uint32_t i = range.begin; i < range.end; ++i)
    work_->between[i] = from_.positions[i] + (to_.positions[i] - from_.positions[i]) * at_.s;
}

void PosedMesh::pose_owned(std::uint32_t c) const {
  work_->owned.once(c, [&] {
    const Stopwatch watch;
    decode_owned(from_, c);
    decode_owned(to_, c);
    if (is_between())
      for (const VertexRange& run : vertices().owned(c)) move_between(run);
    work_->nanoseconds += static_cast<std::uint64_t>(watch.seconds() * 1e9 / thread_count());
  });
}

void PosedMesh::pose_cluster(std::uint32_t c) const {
  for (const std::uint32_t owner : vertices().owners(c)) pose_owned(owner);
  work_->ready.set_done(c);
}

void PosedMesh::require_around(std::uint32_t c) const {
  if (work_->complete) return;
  for (const std::uint32_t near : vertices().around(c)) require(near);
}

void PosedMesh::decode_all(const KeyPose& pose) const {
  if (pose.decoded == nullptr || pose.decoded->complete) return;
  std::vector<Vec3f>& out = pose.decoded->positions;
  parallel_chunks(out.size(), kDecodedPerChunk, [&](std::size_t begin, std::size_t end) {
    const VertexRange range{static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    decode_pose(*model_, *pose.decoded->key, range, std::span(out).subspan(begin, end - begin));
  });
  pose.decoded->complete = true;
}

std::span<const Vec3f> PosedMesh::positions() const {
  if (work_->complete) return positions_;
  const Stopwatch watch;
  decode_all(from_);
  decode_all(to_);
  if (is_between())
    parallel_chunks(positions_.size(), kVerticesPerChunk, [&](std::size_t begin, std::size_t end) {
      move_between({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)});
    });
  work_->complete = true;
  work_->nanoseconds += static_cast<std::uint64_t>(watch.seconds() * 1e9);
  return positions_;
}

std::size_t PosedMesh::posed_count() const {
  if (work_->complete) return positions_.size();
  std::size_t count = 0;
  for (std::uint32_t c = 0; c < model_->cluster_count(); ++c)
    if (work_->owned.is_done(c))
      for (const VertexRange& run : vertices().owned(c)) count += run.size();
  return count;
}

void PosedMesh::set_pose(const SkeletonPose& pose) {
  const ModelView& m = *model_;
  const std::size_t targets = m.poses.rig.target_weights.size() / m.key_count();
  if (m.skeleton.joints.empty())
    throw Error(ErrorCode::kUsage,
                "the model has no skeleton to pose: bake it with --decompose bones --sampling "
                "pose-space");
  if (pose.turns.size() != m.skeleton.joints.size() || pose.target_weights.size() != targets)
    throw Error(ErrorCode::kUsage, "the pose belongs to another skeleton");
  const std::vector<Affine3f> bones = bone_maps(m.skeleton, pose);
  std::vector<Vec3f>& posed = work_->between;
  posed.resize(m.vertex_count);
  parallel_chunks(posed.size(), kDecodedPerChunk, [&](std::size_t begin, std::size_t end) {
    const VertexRange range{static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    pose_vertices(m.poses.rig, {bones, pose.target_weights}, range,
                  std::span(posed).subspan(begin, end - begin));
  });
  positions_ = posed;
  work_->complete = true;
  live_clusters_.resize(m.clusters.size());
  parallel_chunks(live_clusters_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const ClusterBone& follows = m.cluster_bones[c];
      Aabb box;
      for (const Triangle& triangle :
           m.triangles.subspan(m.clusters[c].first_triangle, m.clusters[c].triangle_count))
        for (const std::uint32_t v : triangle.v) box.extend(posed[v]);
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

Aabb cluster_world_box(const ModelView& model, std::uint32_t c, const KeyInterval& at) {
  const Aabb from = model.world_box(at.key0, c);
  if (at.s == 0.0f || at.key0 == at.key1) return from;
  const Aabb to = model.world_box(at.key1, c);
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
