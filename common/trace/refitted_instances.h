// RefittedInstances: what other programs do about a crowd, to measure against: every instance has a
// hierarchy of its own, posed and refitted in every frame. The topology is shared by all of a
// model.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/scene/scene.h"
#include "common/trace/crowd_models.h"
#include "common/trace/kernels/crowd_kernels.h"
#include "common/trace/world_tree.h"

namespace mdk {

class RefittedInstances {
 public:
  /// Poses and refits all instances. Runs in parallel. Cost and memory: O(triangles of all
  /// instances).
  void update(const Stage& stage, std::span<const std::unique_ptr<CrowdModel>> models, double time);

  /// Lets rays of an instance go through its refitted hierarchy.
  void replace(InstanceRays& rays) const;

  std::size_t bytes() const;

 private:
  /// A model of one cluster at one key.
  struct Refitted {
    PosedWorldTree tree;
    RayTree root;
    TopBoxes boxes;
    RayModel model;

    Refitted(const WorldTree& topology, const VertexSource& source);
  };

  std::vector<std::unique_ptr<WorldTree>> topologies_;  ///< by model
  std::vector<std::unique_ptr<Refitted>> instances_;
};

}  // namespace mdk
