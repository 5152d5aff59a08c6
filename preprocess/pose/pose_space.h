// Pose space: everything a skeleton can do within its joints' limits, bounded in closed form
// (Lo09 §4.3 samples it instead). Seen from one bone c, a point that hangs on bone b gets there
// through the joints between the two: up to their common ancestor, down again, each on the way
// turning by at most its limit about its own origin.
//
//             .-´ cap ´-.          a point at m turned by at most L sweeps the cap about m;
//           /      m      \        cap and ball around it: centre m cos L, radius |m| sin L
//          '-_    |L/    _-'       (L up to 90 degrees; beyond, the whole sphere's ball)
//              `- |/ -´
//               origin
//
// So a ball grows along the way: scaled by each map, |m| sin L wider at each joint. The last
// joint's cap is kept as it is, since a box around a cap is exact and smaller than around its ball.
// A vertex with several bones lies in the weighted sum of their boxes; morph targets start it as a
// ball.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "common/math/aabb.h"
#include "common/math/affine3.h"
#include "common/motion/rig.h"

namespace mdk {

/// A rig and the skeleton it hangs on; both must outlive it and have the same bones.
class PoseSpace {
 public:
  PoseSpace(const SkeletonView& skeleton, const RigView& rig, std::uint32_t key_count);

  const SkeletonView& skeleton() const { return skeleton_; }
  const RigView& rig() const { return rig_; }

  /// Where a vertex can be before bones move it: a ball around its base position, over all morph
  /// weights between the smallest and the largest of any key.
  struct Ball {
    Vec3d center;
    double radius = 0;
  };
  Ball base_ball(std::uint32_t vertex) const;

  /// Largest distance from the world's origin that numbers on the way to a posed vertex can have.
  double reach() const { return reach_; }

 private:
  SkeletonView skeleton_;
  RigView rig_;
  std::vector<float> min_weights_, max_weights_;  ///< per morph target
  double reach_ = 0;
};

/// The pose space as one bone sees it. One object serves one thread.
class BoneSpace {
 public:
  BoneSpace(const PoseSpace& space, std::uint32_t bone);

  /// Whether the bone's chain of joints can be inverted at all: without it there are no boxes.
  bool is_usable() const { return usable_; }

  /// A box that holds the vertex in every pose within limits, in the basis `local_from_base` (the
  /// bone's base space, mapped). Covers what the run time rounds. Cost: O(its bones * joints
  /// between).
  Aabbd vertex_box(std::uint32_t vertex, const Affine3d& local_from_base);

 private:
  /// maps[0], turn by limits[0], maps[1], ... : from a bone's base space to this one's.
  struct Path {
    std::vector<Affine3d> maps;
    std::vector<double> stretch;  ///< per map: how much longer it makes a vector at most
    std::vector<double> limits;   ///< one fewer
  };

  Path make_path(std::uint32_t from) const;
  const Path& path_from(std::uint32_t bone);

  const PoseSpace& space_;
  std::uint32_t bone_;
  bool usable_ = true;
  double rounding_ = 0;         ///< of a posed vertex, mapped back to base space
  double origin_distance_ = 0;  ///< at most: of the world's origin, seen from base space
  std::map<std::uint32_t, Path> paths_;
};

}  // namespace mdk
