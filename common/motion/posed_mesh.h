// PosedMesh: a model's vertices and clusters at one moment, or as its skeleton is posed by hand.
// Vertices are posed when someone asks for them, all at once or cluster by cluster: clusters that
// no ray comes near cost nothing.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "common/base/parallel.h"
#include "common/motion/model.h"

namespace mdk {

/// Which vertices belong to which cluster, so that a cluster can be posed alone: every vertex that
/// a triangle uses is owned by the first cluster that uses it. Memory: O(runs of vertices + pairs
/// of clusters that touch).
class ClusterVertices {
 public:
  /// Cost: O(triangles).
  explicit ClusterVertices(const ModelView& model);

  /// The vertices that cluster `c` owns, as ascending ranges.
  std::span<const VertexRange> owned(std::uint32_t c) const { return owned_.of(c); }
  /// The clusters that own the corners of its triangles, itself among them where it owns any.
  std::span<const std::uint32_t> owners(std::uint32_t c) const { return owners_.of(c); }
  /// The clusters it shares a vertex with, itself included.
  std::span<const std::uint32_t> around(std::uint32_t c) const { return around_.of(c); }

 private:
  /// One list per cluster, one after another.
  template <class T>
  struct Lists {
    std::vector<std::uint32_t> first{0};
    std::vector<T> items;

    std::span<const T> of(std::uint32_t c) const {
      return std::span(items).subspan(first[c], first[c + 1] - first[c]);
    }
    void end_list() { first.push_back(static_cast<std::uint32_t>(items.size())); }
  };

  Lists<VertexRange> owned_;
  Lists<std::uint32_t> owners_, around_;
};

/// The pose of `model` at an interval: v0 + s (v1 - v0) of two decoded key poses, in float, per
/// coordinate; the same bits whoever asks in whatever order. What was decoded of the last two keys
/// is kept, so that playing decodes each key once. Where the model holds key positions, they are
/// used in place.
class PosedMesh {
 public:
  explicit PosedMesh(const ModelView& model) : model_(&model) {}

  /// Moves to another moment. Cost: O(clusters).
  void set_time(const KeyInterval& at);

  /// Poses the skeleton, until the next set_time(). Boxes hold where no joint is past its limit
  /// (joint_past_limit) and morph weights stay between the least and the largest of the keys.
  /// Throws Error (kUsage) where the model has no skeleton, or another than the pose. Cost:
  /// O(vertices + triangles). Runs in parallel.
  void set_pose(const SkeletonPose& pose);

  const ModelView& model() const { return *model_; }
  /// The last moment; what is_live() is not at a moment.
  const KeyInterval& at() const { return at_; }
  bool is_live() const { return !live_clusters_.empty(); }

  /// All positions. Poses what is missing, in parallel; free where nothing is. Not while other
  /// threads ask for clusters.
  std::span<const Vec3f> positions() const;

  /// Afterwards the corners of the triangles of cluster `c` stand at their numbers in
  /// posed_so_far(). Any number of threads may ask at once; one that needs vertices another thread
  /// is at waits for it.
  void require(std::uint32_t c) const {
    if (!work_->complete && !work_->ready.is_done(c)) pose_cluster(c);
  }
  /// The same for all triangles around the vertices of cluster `c`.
  void require_around(std::uint32_t c) const;
  /// Positions of what was required; the rest is of other moments, or nothing.
  const Vec3f* posed_so_far() const { return positions_.data(); }

  /// How many vertices have been posed for this moment; all of them where they are used in place.
  std::size_t posed_count() const;
  /// What posing has cost so far, in seconds per thread that may run.
  double posing_seconds() const { return static_cast<double>(work_->nanoseconds) * 1e-9; }

  /// local_from_world of cluster `c` now.
  Affine3d cluster_map(std::uint32_t c) const;
  /// World box of cluster `c` now: holds all its vertices.
  Aabb cluster_box(std::uint32_t c) const;

 private:
  /// A key pose, decoded where it was needed.
  struct DecodedKey {
    std::optional<std::uint32_t> key;
    std::vector<Vec3f> positions;
    OnceMarks owned;        ///< by cluster: what it owns is decoded
    bool complete = false;  ///< all of it is
  };
  /// A key pose to take positions from: the model's own, or a decoded one.
  struct KeyPose {
    const Vec3f* positions = nullptr;
    DecodedKey* decoded = nullptr;  ///< null where the positions are the model's own
  };
  struct LiveCluster {
    Affine3d local_from_world;
    Aabb box;
  };
  /// What posing on demand changes.
  struct Work {
    DecodedKey decoded[2];
    std::vector<Vec3f> between;
    OnceMarks owned;       ///< by cluster: what it owns is posed
    OnceMarks ready;       ///< by cluster: the corners of its triangles are posed
    bool complete = true;  ///< all vertices are posed
    std::once_flag vertices_known;
    std::optional<ClusterVertices> vertices;
    std::atomic<std::uint64_t> nanoseconds = 0;
  };

  /// The pose at a key; what `kept` names stays decoded.
  KeyPose key_pose(std::uint32_t key, std::uint32_t kept);
  const ClusterVertices& vertices() const;
  void pose_cluster(std::uint32_t c) const;
  void pose_owned(std::uint32_t c) const;
  void decode_owned(const KeyPose& pose, std::uint32_t c) const;
  void decode_all(const KeyPose& pose) const;
  void move_between(const VertexRange& range) const;
  bool is_between() const { return to_.positions != nullptr; }

  const ModelView* model_;
  KeyInterval at_;
  std::span<const Vec3f> positions_;
  KeyPose from_, to_;  ///< the keys around; `to_` only between two
  std::unique_ptr<Work> work_ = std::make_unique<Work>();
  std::vector<LiveCluster> live_clusters_;  ///< K while posed by hand, else none
};

/// World box of cluster `c` at a moment: holds all its vertices. Linear between keys, which bounds
/// linearly moving vertices (docs/method.md, time between keys).
Aabb cluster_world_box(const ModelView& model, std::uint32_t c, const KeyInterval& at);

/// Boxes of all triangles in the current pose, in triangle order; `boxes` has one per triangle.
/// None is empty or infinite: a triangle with a corner that is not finite cannot be hit
/// (docs/kernels.md), and gets a point. Runs in parallel.
void triangle_boxes(const PosedMesh& mesh, std::span<Aabb> boxes);

}  // namespace mdk
