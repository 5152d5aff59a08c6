// Embree as a peer for single rays. Motion blur: every key a time step; Embree takes 129 of them at
// most, so a clip of more keys is cut into scenes, of which a ray meets the one that has its time.
#include "common/trace/techniques/embree_rays.h"

#ifdef MDK_HAVE_EMBREE
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <vector>

#include "common/base/error.h"
#include "common/base/stopwatch.h"
#include "common/motion/posed_mesh.h"
#include "common/trace/techniques/embree_device.h"

namespace mdk {
namespace {

class EmbreeRays final : public PeerRays {
 public:
  EmbreeRays(const ModelView& model, PeerMode mode, const std::optional<KeyInterval>& moment)
      : model_(model), mode_(mode), device_(rtcNewDevice(embree_device_config().c_str())) {
    require_embree_success(device_);
    rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
    if (moment) {
      poses_.resize(1);
      PosedMesh mesh(model);
      mesh.set_time(*moment);
      const std::span<const Vec3f> positions = mesh.positions();
      poses_[0].assign(positions.begin(), positions.end());
      poses_[0].emplace_back();  // Embree loads sixteen bytes a vertex
      add_scene(0, 1);
      return;
    }
    decode_keys();
    for (const Clip& clip : model.clips) {
      const std::uint32_t last = clip.first_key + clip.key_count - 1;
      std::uint32_t first = clip.first_key;
      do {
        const std::uint32_t end = std::min(last, first + kMaxSteps - 1);
        for (std::uint32_t key = first; key <= end; ++key)
          if (key == clip.first_key || key != first)
            scene_of_key_.push_back(static_cast<std::uint32_t>(scenes_.size()));
        ranges_.push_back({first, end});
        add_scene(first, end - first + 1);
        first = end;
      } while (first < last);
    }
  }
  ~EmbreeRays() override {
    for (RTCScene scene : scenes_) rtcReleaseScene(scene);
    rtcReleaseDevice(device_);
  }
  EmbreeRays(const EmbreeRays&) = delete;
  EmbreeRays& operator=(const EmbreeRays&) = delete;

  Time at(const KeyInterval& time) const override {
    if (ranges_.empty()) return {};
    const std::uint32_t scene = scene_of_key_[time.key1];
    const auto [first, last] = ranges_[scene];
    if (first == last) return {scene, 0};
    const double place = time.key0 - first + static_cast<double>(time.s);
    return {scene, static_cast<float>(place / (last - first))};
  }

  QueryHit trace(const QueryRay& ray, const Time& time, RayAim aim) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query;
    query.ray = {ray.origin.x,
                 ray.origin.y,
                 ray.origin.z,
                 ray.t_min,
                 ray.direction.x,
                 ray.direction.y,
                 ray.direction.z,
                 time.time,
                 ray.t_max,
                 ~0u,
                 0,
                 0};
    if (aim == RayAim::kAny) {
      rtcOccluded1(scenes_[time.scene], &context, &query.ray);
      return query.ray.tfar < 0 ? QueryHit{0, 0, 0, 0} : QueryHit{};
    }
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scenes_[time.scene], &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {query.ray.tfar, query.hit.primID, query.hit.u, query.hit.v};
  }

  std::size_t bytes() const override {
    std::size_t sum = static_cast<std::size_t>(bytes_);
    for (const std::vector<Vec3f>& pose : poses_) sum += pose.size() * sizeof(Vec3f);
    return sum;
  }
  double build_ms() const override { return build_ms_; }

 private:
  static constexpr std::uint32_t kMaxSteps = RTC_MAX_TIME_STEP_COUNT;

  void decode_keys() {
    poses_.resize(model_.key_count());
    for (std::uint32_t key = 0; key < model_.key_count(); ++key) {
      PosedMesh mesh(model_);
      mesh.set_time(at_key(key));
      const std::span<const Vec3f> positions = mesh.positions();
      poses_[key].assign(positions.begin(), positions.end());
      poses_[key].emplace_back();
    }
  }

  void add_scene(std::uint32_t first_pose, std::uint32_t steps) {
    const Stopwatch watch;
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryTimeStepCount(geometry, steps);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               model_.triangles.data(), 0, sizeof(Triangle),
                               model_.triangles.size());
    for (std::uint32_t step = 0; step < steps; ++step)
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3,
                                 poses_[first_pose + step].data(), 0, sizeof(Vec3f),
                                 model_.vertex_count);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    RTCScene scene = rtcNewScene(device_);
    scenes_.push_back(scene);
    rtcSetSceneFlags(scene,
                     mode_ == PeerMode::kRobust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    require_embree_success(device_);
    build_ms_ += watch.milliseconds();
  }

  static bool count_bytes(void* total, ssize_t bytes, bool) {
    *static_cast<std::atomic<ssize_t>*>(total) += bytes;
    return true;
  }

  struct KeyRange {
    std::uint32_t first, last;
  };

  const ModelView model_;
  const PeerMode mode_;
  std::atomic<ssize_t> bytes_ = 0;  // outlives the device, which reports to it until the end
  RTCDevice device_;
  std::vector<std::vector<Vec3f>> poses_;
  std::vector<RTCScene> scenes_;
  std::vector<KeyRange> ranges_;             ///< of each scene; none for one moment
  std::vector<std::uint32_t> scene_of_key_;  ///< the scene that holds the interval before a key
  double build_ms_ = 0;
};

}  // namespace

std::unique_ptr<PeerRays> make_embree_rays(const ModelView& model, PeerMode mode,
                                           const std::optional<KeyInterval>& moment) {
  return std::make_unique<EmbreeRays>(model, mode, moment);
}

}  // namespace mdk
#else
namespace mdk {
std::unique_ptr<PeerRays> make_embree_rays(const ModelView&, PeerMode,
                                           const std::optional<KeyInterval>&) {
  return nullptr;
}
}  // namespace mdk
#endif
