// Technique: one way to keep an acceleration structure valid while the pose changes, behind one
// interface, and the table of those there are (docs/method.md, techniques).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "common/motion/posed_mesh.h"
#include "common/trace/camera.h"
#include "common/trace/frame_stats.h"
#include "common/trace/hit_buffer.h"
#include "common/trace/kernels/beam_kernels.h"
#include "common/trace/kernels/tile_kernels.h"

namespace mdk {

/// Every technique of ours returns brute force's closest hit, bit for bit: a structure only chooses
/// which triangles are tested. Peers have a triangle test of their own (TechniqueInfo). One object
/// serves one model; update() and trace() alternate, trace() may run on many threads at once.
class Technique {
 public:
  virtual ~Technique() = default;

  /// Work that can be done ahead of the frame, timed apart from it (static trees for this pose).
  virtual void prebuild(const PosedMesh&) {}

  /// Makes the structure valid for this pose. The mesh must outlive what is traced of it.
  virtual void update(const PosedMesh& mesh) = 0;

  /// What the view asks for once per frame, before any tile: maps of the rays per cluster.
  /// O(clusters).
  virtual void set_view(const PinholeRays&) {}

  /// Closest hits of one tile. Returns whether there are any; `hits` is written whole then, and
  /// else left alone.
  virtual bool trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
                     TraceCounters* counters) const = 0;

  /// Readies what occlude() needs, once per frame after update() and only for frames that are lit.
  /// O(clusters), but for those that keep nothing of the kind.
  virtual void prepare_occlusion() {}

  /// Which rays of the beam hit the mesh. Techniques of ours agree on every ray, to the bit.
  virtual void occlude(RayBeam& beam, TileScratch& scratch) const = 0;

  /// Memory of the structures, in bytes, without the mesh itself.
  virtual std::size_t structure_bytes() const = 0;

  /// One line for people about what it did and why, or nothing. Not during a frame.
  virtual std::string note() const { return {}; }
};

/// What hits and counts of work depend on. All but peers give brute force's hits to the bit.
enum class TechniqueKind {
  kStructure,  ///< counts depend on the model, the moment and the view alone
  kHistory,    ///< counts depend on the frames shown before, too: so does its structure
  kAdaptive,   ///< counts are those of its choice among others, which it makes by the clock
  kPeer,       ///< another program with a triangle test of its own: agrees in depth, counts nothing
  kOracle,     ///< brute force
};

struct TechniqueInfo {
  std::string_view id;       ///< as on the command line
  std::string_view label;    ///< as in the panel
  std::string_view summary;  ///< half a sentence
  std::string_view source;
  std::unique_ptr<Technique> (*make)(const ModelView&);
  TechniqueKind kind = TechniqueKind::kStructure;
  /// What a triangle test costs in traversal steps where its kd-trees are built, by this program
  /// (KdBuildConfig); 0 for techniques without kd-trees.
  float kd_cost_ratio = 0;

  /// How its hits are compared with brute force's.
  Agreement agreement() const {
    return kind == TechniqueKind::kPeer ? Agreement::kSameDepth : Agreement::kBitIdentical;
  }
};

/// All techniques, best known first, then peers where they were built in, brute force last.
std::span<const TechniqueInfo> technique_table();

/// The row with this id; throws Error (kUsage) with the ids there are.
const TechniqueInfo& find_technique(std::string_view id);

}  // namespace mdk
