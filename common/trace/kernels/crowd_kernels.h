// Tiles of rays through a scene of many instances, behind run-time dispatch. Three levels: boxes of
// instances, boxes of an instance's clusters, triangles. A tile enters an instance as a frustum,
// mapped into the model, or, where the instance has few pixels, as a line for each of them. Both
// end in the tile's own triangle test, so it does not matter which way a pixel goes
// (docs/crowds.md).
#pragma once

#include <cstdint>
#include <span>

#include "common/scene/scene.h"
#include "common/trace/kernels/ray_kernels.h"
#include "common/trace/kernels/tile_kernels.h"

namespace mdk {

/// Which instance each pixel of a tile hits, beside TileHits; kNoHit where none.
struct alignas(64) TileInstances {
  std::uint32_t instance[kTilePixels];
};

/// Work of tracing a scene. As TraceCounters, and:
struct CrowdCounters {
  TraceCounters work;
  std::uint64_t instances_entered = 0;  ///< tile-instance pairs whose clusters were looked at
  std::uint64_t lines = 0;              ///< pixels that went alone

  CrowdCounters& operator+=(const CrowdCounters& b) {
    work += b.work;
    instances_entered += b.instances_entered;
    lines += b.lines;
    return *this;
  }
};

/// Pixels by the coordinates of their centres, ends included, and the depth of what is seen there.
struct ScreenBox {
  float first_x, last_x, first_y, last_y;
  float nearest;  ///< no part has a smaller depth; 0 where some part may be behind the eye
};

/// An instance as the rays of a frame meet it: the picture's pinhole in the model's space. Image
/// points count from a whole tile near the instance, so that coordinates, and with them what
/// rounding does to a small character, are small.
struct InstanceRays {
  std::uint32_t instance;
  float shift_x, shift_y;  ///< the tile's corner in the picture
  PinholeRays rays;
  PixelFromWorld pixel_from_model;
  KeyInterval at;    ///< where boxes and maps are taken from
  KeyInterval time;  ///< of the instance: where its vertices are
  std::uint32_t segment;
  const RayModel* model;
  VertexSource vertices;
  alignas(16) float lo[4], hi[4], size[4];  ///< of the model at its time; size: from 0
  ScreenBox screen;  ///< in the picture, where no pixel outside hits the instance
  bool has_lines;    ///< its pixels go one by one
  float line_slack;  ///< by what boxes in the model must give way to a pixel's line
  /// By how much a hit may be nearer than where the line enters the hit triangle's box, given how
  /// long the triangle's edges may be: `edges` of each cluster, at both keys.
  struct Reach {
    float base, per_edge;
    float of(float edge) const { return base + per_edge * edge; }
  };
  Reach line_reach;
  const float* edges[2];
  float longest_edge;
};

/// What bounds a frame's rays in the basis of each cluster of an instance.
class InstanceSource {
 public:
  virtual ~InstanceSource() = default;
  /// Null where the instance is not shown. Holds until the next call.
  virtual const InstanceRays* enter(std::uint32_t instance) = 0;
  /// Of the instance entered last: the forms of its clusters' boxes in the model, and of a
  /// cluster's own tree.
  virtual const FrustumForms& model_forms() = 0;
  virtual const FrustumForms& cluster_forms(std::uint32_t cluster) = 0;
};

/// Hierarchies over boxes of instances: those that stand still, and those that move. A leaf is the
/// instance of its number.
struct CrowdView {
  struct Tree {
    std::span<const WideBvhNode> nodes;
    FrustumForms forms;
  };
  Tree trees[2];
  const SceneInstance* instances;  ///< what entering one reads: fetched early
  PixelFromWorld pixel_from_world;
  float slack;          ///< what a box must give way by, as a share of its distance
  float columns, rows;  ///< of the picture
};

/// Per-thread memory of the kernels: blocks as lines of the instance at hand have last seen them.
struct CrowdScratch {
  static constexpr std::size_t kBlocks = 128;
  struct Entry {
    const RayBlock* block = nullptr;
    std::uint64_t entered = 0;  ///< which entering of an instance it is of
  };
  Entry entries[kBlocks];
  std::uint64_t entered = 0;
  ProjectedBlock projected[kBlocks];
};

/// Closest hits: the largest inverse depth, ties to the lower instance, then to the lower triangle.
/// Returns whether a ray hits; hits and instances are written whole then, and else left alone.
/// `counters` may be null.
bool trace_crowd_tile(const TileRays& tile, const CrowdView& view, InstanceSource& source,
                      CrowdScratch& scratch, TileHits& hits, TileInstances& instances,
                      CrowdCounters* counters);

/// An instance with all its triangles and their posed corners.
struct BruteInstance {
  InstanceRays rays;
  std::span<const TriangleBlock> blocks;
  const Vec3f* positions;
};

/// The same hits without a structure: every tile tests every triangle of every instance.
bool trace_crowd_brute(const TileRays& tile, std::span<const BruteInstance> all, TileHits& hits,
                       TileInstances& instances);

}  // namespace mdk
