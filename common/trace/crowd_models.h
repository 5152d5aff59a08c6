// CrowdModels: what the models of a scene hold for its pictures, made once and shared by all
// instances, whatever their times: hierarchies, key poses and what is known of each key.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "common/motion/model.h"
#include "common/trace/ray_tracer.h"

namespace mdk {

/// One model. Safe to use from many threads at once; the model must outlive it.
class CrowdModel {
 public:
  /// Cost: O(segments * T log T); runs in parallel. `max_pose_bytes`: see RayTracer.
  CrowdModel(const ModelView& model, std::size_t max_pose_bytes);

  const ModelView& model() const { return tracer_.model(); }
  const RayTracer& tracer() const { return tracer_; }

  /// Per cluster, and then of all: no edge of a triangle is longer at this key. Cost: O(1), but
  /// O(T) the first time.
  const float* longest_edges(std::uint32_t key) const { return facts(key).longest_edges.data(); }
  /// Smooth normals of all vertices at a key, in the model: unit, weighted by area, or zero where
  /// the triangles around a vertex have no direction. Cost: O(1), but O(T) the first time.
  /// Of models that keep them only: those whose normals of all keys are few.
  std::span<const Vec3f> normals(std::uint32_t key) const;
  bool keeps_normals() const { return first_corner_.empty(); }
  /// Of models that do not: the triangles around a vertex.
  std::span<const std::uint32_t> triangles_around(std::uint32_t vertex) const {
    return std::span(ring_).subspan(first_corner_[vertex],
                                    first_corner_[vertex + 1] - first_corner_[vertex]);
  }

  /// What serves every frame, and what keys have been worked out for.
  std::size_t structure_bytes() const;
  std::size_t cache_bytes() const;

 private:
  struct KeyFacts {
    std::atomic<bool> ready = false, has_normals = false;
    std::once_flag once, normals_once;
    std::vector<float> longest_edges;
    std::vector<Vec3f> normals;
  };
  const KeyFacts& facts(std::uint32_t key) const {
    const KeyFacts& known = keys_[key];
    return known.ready.load(std::memory_order_acquire) ? known : find(key);
  }
  const KeyFacts& find(std::uint32_t key) const;
  std::vector<Vec3f> positions(std::uint32_t key) const;

  RayTracer tracer_;
  std::size_t own_bytes_ = 0;  ///< of the tracer before any key is decoded
  mutable std::atomic<std::size_t> cached_ = 0;
  std::unique_ptr<KeyFacts[]> keys_;
  std::vector<std::uint32_t> first_corner_, ring_;  ///< where normals are not kept
};

}  // namespace mdk
