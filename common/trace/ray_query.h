// RayQuery: single rays for shadows, ambient occlusion and programs. Each ray may have a time of
// its own: the fuzzy structures hold at every time, so one of them serves motion blur, a rolling
// shutter, a lidar sweep and a crowd in which everyone is at another time (docs/ray-queries.md).
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <span>

#include "common/motion/model.h"
#include "common/motion/posed_mesh.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/ray_kernels.h"

namespace mdk {

/// origin + t direction, for t in (t_min, t_max]; both may be negative.
struct QueryRay {
  Vec3f origin;
  Vec3f direction;  ///< of any length but zero; t counts in this length
  float t_min = 0;
  float t_max = std::numeric_limits<float>::infinity();
};

/// What was hit: kNoHit and an infinite t for nothing. Corners 1 and 2 have the barycentric
/// coordinates bary1 and bary2.
using QueryHit = RayHit;

/// The model at one moment: clusters' maps and boxes, ready for rays. Vertices between keys are not
/// posed: a ray interpolates those it needs.
class QueryMoment;

/// The model must outlive it. All members but the constructor may be called from many threads at
/// once.
class RayQuery {
 public:
  /// Builds one hierarchy per cluster and segment. Cost: O(segments * T log T). Runs in parallel.
  /// Key poses that are not stored as positions are decoded when a ray first asks for them, and
  /// kept: 12 bytes a vertex for every such key.
  explicit RayQuery(const ModelView& model);
  ~RayQuery();
  RayQuery(const RayQuery&) = delete;
  RayQuery& operator=(const RayQuery&) = delete;

  /// The closest hit at the ray's own time (locate_time()), ties to the lower triangle: brute
  /// force's over the same triangle test, bit for bit, on every machine. No ray slips between
  /// triangles that share an edge. A ray that has no direction or is not finite hits nothing.
  /// Cost: O(clusters) on top of the walk.
  QueryHit closest_hit(const QueryRay& ray, const KeyInterval& at) const;

  /// Whether the ray hits anything at its own time.
  bool any_hit(const QueryRay& ray, const KeyInterval& at) const;

  /// For many rays at one time: what they share, computed once. O(clusters).
  std::shared_ptr<const QueryMoment> prepare(const KeyInterval& at) const;
  QueryHit closest_hit(const QueryRay& ray, const QueryMoment& moment) const;
  bool any_hit(const QueryRay& ray, const QueryMoment& moment) const;

  /// A list of rays, each at its own time; all lists have one length. Run in parallel.
  void closest_hits(std::span<const QueryRay> rays, std::span<const KeyInterval> times,
                    std::span<QueryHit> hits) const;
  void any_hits(std::span<const QueryRay> rays, std::span<const KeyInterval> times,
                std::span<std::uint8_t> hits) const;

  std::size_t structure_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The closest hit among all triangles, with no structure at all: what RayQuery is judged by.
QueryHit brute_force_closest_hit(const ModelView& model, const QueryRay& ray,
                                 const KeyInterval& at);
/// The same for a mesh that is posed already, by hand or at a moment.
QueryHit brute_force_closest_hit(const PosedMesh& mesh, const QueryRay& ray);

}  // namespace mdk
