// InstancePool: what a thread knows of the instances that its tiles have entered in a frame, in a
// fixed number of places: an instance costs nothing until a ray comes near it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/scene/scene.h"
#include "common/trace/camera.h"
#include "common/trace/crowd_models.h"
#include "common/trace/kernels/crowd_kernels.h"
#include "common/trace/refitted_instances.h"

namespace mdk {

/// A scene at a time, as a camera sees it.
struct CrowdFrame {
  const Stage* stage;
  std::span<const std::unique_ptr<CrowdModel>> models;  ///< as the stage has them
  double time = 0;
  PinholeRays rays;
  PixelFromWorld pixel_from_world;
  std::uint32_t width = 0, height = 0;
  /// An instance of so many pixels a triangle, or fewer, is traced pixel by pixel: as a frustum it
  /// would enter more blocks than that.
  float line_share = 0;
  const RefittedInstances* refitted = nullptr;  ///< what instances go through instead, if anything
};

/// The rays of a frame in the model of an instance that is shown. The agreed rounding: image points
/// count from the tile in which the middle of the instance's box is seen, that pinhole is mapped
/// into the model (map_point, map_vector), and the triangle test is that of any picture.
InstanceRays make_instance_rays(const CrowdFrame& frame, std::uint32_t instance);

/// Not for use from several threads at once.
class InstancePool final : public InstanceSource {
 public:
  /// For at most `bytes`, but for a few places that it needs in any case.
  InstancePool(std::span<const std::unique_ptr<CrowdModel>> models, std::size_t bytes);

  /// Forgets all; the frame must outlive its tiles.
  void begin_frame(const CrowdFrame& frame);

  const InstanceRays* enter(std::uint32_t instance) override;
  /// Lets go of the key poses of the instance entered last; to be called before the thread does
  /// anything else with its model.
  void leave();
  const FrustumForms& model_forms() override;
  const FrustumForms& cluster_forms(std::uint32_t cluster) override;

  std::uint64_t instances_posed() const { return posed_; }
  std::size_t bytes() const;

 private:
  struct Place {
    InstanceRays rays;
    std::uint64_t serial = 0;  ///< of the frame it belongs to
    bool is_shown = false;
    std::uint32_t forms_of = kNoHit;  ///< whose forms stand in `forms`
    std::uint64_t forms_serial = 0;
    std::vector<FrustumForms> forms;  ///< of clusters, then of the model
    std::vector<std::uint8_t> has_forms;
  };
  void begin_forms();

  const CrowdFrame* frame_ = nullptr;
  std::uint64_t serial_ = 0, posed_ = 0;
  std::vector<Place> places_;  ///< a power of two
  Place* current_ = nullptr;
  const KeyPoses* held_ = nullptr;
  KeyInterval held_time_;
};

}  // namespace mdk
