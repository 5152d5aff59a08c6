// RayQuery: single rays for shadows, ambient occlusion and programs. Each ray may have a time of
// its own: the structures of a model hold at every time, so one query serves motion blur, a rolling
// shutter, a lidar sweep and a crowd in which everyone is at another time (docs/ray-queries.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "mdk/geometry.h"
#include "mdk/model.h"

namespace mdk {

/// origin + t direction, for t in (t_min, t_max]; both may be negative. A ray that has no direction
/// or is not finite hits nothing.
struct QueryRay {
  Vec3f origin;
  Vec3f direction;  ///< of any length but zero; t counts in this length
  float t_min = 0;
  float t_max = std::numeric_limits<float>::infinity();
};

constexpr std::uint32_t kNoTriangle = 0xFFFFFFFF;

/// What was hit: kNoTriangle and an infinite t for nothing.
struct QueryHit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = kNoTriangle;
  float bary1 = 0, bary2 = 0;  ///< barycentric coordinates of corners 1 and 2

  bool is_hit() const { return triangle != kNoTriangle; }
};

/// What of a surface costs more than looking it up.
enum class SurfaceParts : std::uint32_t {
  kPlain = 0,         ///< position, normal, material, source triangle
  kSmoothNormal = 1,  ///< else it is the normal
  kVelocity = 2,      ///< else 0
  kPaint = 4,         ///< texture coordinates and base colour; else 0
  kAll = 7,
};
constexpr SurfaceParts operator|(SurfaceParts a, SurfaceParts b) {
  return static_cast<SurfaceParts>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr bool has(SurfaceParts parts, SurfaceParts part) {
  return (static_cast<std::uint32_t>(parts) & static_cast<std::uint32_t>(part)) != 0;
}

/// What lies where a ray hit.
struct Surface {
  Vec3f position;       ///< on the triangle, by its barycentric coordinates
  Vec3f normal;         ///< the triangle's own, of unit length, outward; 0 for one without area
  Vec3f smooth_normal;  ///< of unit length, interpolated between the vertices
  Vec3f velocity;  ///< of the material point: units a second of the clip. At a key, as it goes on
  float u = 0, v = 0;        ///< texture coordinates as in glTF
  float base_color[4] = {};  ///< linear RGBA, with texture and vertex colours
  std::uint32_t material = 0;
  std::uint32_t source_triangle = 0;  ///< its number in the mesh that was baked
};

/// One time made ready for many rays. Copies are cheap; each keeps what it needs alive.
class QueryMoment {
 public:
  // No moves: a moment is never empty.
  QueryMoment(const QueryMoment&) = default;
  QueryMoment& operator=(const QueryMoment&) = default;

 private:
  friend class RayQuery;
  struct Data;
  explicit QueryMoment(std::shared_ptr<const Data> data);
  std::shared_ptr<const Data> data_;
};

struct RayQueryOptions {
  /// What decoded key poses may take, in bytes: past it, those that were not used for a while are
  /// decoded again when a ray asks for them. Two poses for every thread that traces are kept in any
  /// case. Rays in the order of their times are then the quickest.
  std::size_t max_pose_bytes = std::size_t{256} << 20;
};

/// Copies are cheap and count as one query. All members but the constructor may be called from many
/// threads at once. Times are of Model::locate_time() or at_key(); one that the model does not have
/// throws Error (kUsage).
class RayQuery {
 public:
  /// Builds one hierarchy per cluster and segment, and keeps the model. Cost: O(segments * T log
  /// T). Runs in parallel. Key poses that are not stored as positions are decoded when a ray first
  /// asks for them, and kept: 12 bytes a vertex for every such key, within `options`.
  explicit RayQuery(const Model& model, const RayQueryOptions& options = {});

  // No moves: a query is never empty.
  RayQuery(const RayQuery&) = default;
  RayQuery& operator=(const RayQuery&) = default;

  /// The closest hit at the ray's own time, ties to the lower triangle: brute force's over the same
  /// triangle test, bit for bit, on every machine. No ray slips between triangles that share an
  /// edge. Allocates nothing, but for decoded poses.
  QueryHit closest_hit(const QueryRay& ray, const KeyInterval& time) const;

  /// Whether the ray hits anything at its own time.
  bool any_hit(const QueryRay& ray, const KeyInterval& time) const;

  /// For many rays at one time. Costs nothing yet: once enough rays were traced for it to pay, the
  /// model is posed and one hierarchy over it refitted, O(T), kept as long as the moment.
  QueryMoment prepare(const KeyInterval& time) const;
  /// Throws Error (kUsage) for a moment of another query.
  QueryHit closest_hit(const QueryRay& ray, const QueryMoment& moment) const;
  bool any_hit(const QueryRay& ray, const QueryMoment& moment) const;

  /// `count` rays, each at its own time: ray i at times[i] gives hits[i], of any_hits() 0 or 1. Run
  /// in parallel. Where a time is not the model's, some hits may have been written.
  void closest_hits(const QueryRay* rays, const KeyInterval* times, QueryHit* hits,
                    std::size_t count) const;
  void any_hits(const QueryRay* rays, const KeyInterval* times, std::uint8_t* hits,
                std::size_t count) const;

  /// What the query holds now, in bytes: hierarchies, and what it has kept of keys and moments.
  std::size_t bytes() const;

  /// Every hit in (t_min, t_max], ascending by t, then by triangle.
  std::vector<QueryHit> all_hits(const QueryRay& ray, const KeyInterval& time) const;

  /// The closest point of the mesh within `radius` (itself included), ties to the lower triangle: t
  /// is the distance. Throws Error (kUsage) for a point that is not finite, or a radius that is
  /// NaN.
  QueryHit closest_point(const Vec3f& point, float radius, const KeyInterval& time) const;

  /// What lies at a hit of this model at its time. Throws Error (kUsage) for a miss. Cost: O(1);
  /// the first smooth normal O(triangles).
  Surface surface(const QueryHit& hit, const KeyInterval& time,
                  SurfaceParts parts = SurfaceParts::kAll) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace mdk
