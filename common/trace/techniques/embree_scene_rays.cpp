#include "common/trace/techniques/embree_scene_rays.h"

#ifdef MDK_HAVE_EMBREE
#include <embree3/rtcore.h>

#include <atomic>
#include <cmath>
#include <vector>

#include "common/base/stopwatch.h"
#include "common/motion/model_handle.h"
#include "common/motion/posed_mesh.h"
#include "common/trace/techniques/embree_device.h"

namespace mdk {
namespace {

constexpr std::uint32_t kMaxSteps = RTC_MAX_TIME_STEP_COUNT;

/// What an instance's primitive needs, in one cache line.
struct alignas(64) InstanceRecord {
  float map[3][4];                    ///< model_from_world
  float start_turns, turns_a_second;  ///< of the clip
  RTCScene scene;
};

/// What rides along with a ray.
struct TimedContext {
  RTCIntersectContext context;
  double time;
};

void map_ray(const InstanceRecord& record, const RTCRay& ray, double time, RTCRay& local) {
  const auto row = [&](int k, float x, float y, float z) {
    return record.map[k][0] * x + record.map[k][1] * y + record.map[k][2] * z;
  };
  local = ray;
  local.org_x = row(0, ray.org_x, ray.org_y, ray.org_z) + record.map[0][3];
  local.org_y = row(1, ray.org_x, ray.org_y, ray.org_z) + record.map[1][3];
  local.org_z = row(2, ray.org_x, ray.org_y, ray.org_z) + record.map[2][3];
  local.dir_x = row(0, ray.dir_x, ray.dir_y, ray.dir_z);
  local.dir_y = row(1, ray.dir_x, ray.dir_y, ray.dir_z);
  local.dir_z = row(2, ray.dir_x, ray.dir_y, ray.dir_z);
  const double turns =
      static_cast<double>(record.start_turns) + static_cast<double>(record.turns_a_second) * time;
  local.time = static_cast<float>(turns - std::floor(turns));
}

class EmbreeSceneRays final : public PeerSceneRays {
 public:
  EmbreeSceneRays(const Stage& stage, PeerMode mode)
      : stage_(stage), mode_(mode), device_(rtcNewDevice(embree_device_config().c_str())) {
    require_embree_success(device_);
    rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
    const Stopwatch watch;
    for (const SceneRole& role : stage.scene().roles) add_role(role);
    for (std::uint32_t i = 0; i < stage.instance_count(); ++i) {
      const SceneInstance& instance = stage.scene().instances[i];
      const Affine3f map = to_float(stage.model_from_world(i, 0));
      InstanceRecord& record = records_.emplace_back();
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) record.map[row][column] = map.m[row][column];
      const ModelView& model = stage.model_of(i);
      const double seconds = model.clip_seconds(model.clips[stage.role(i).clip]);
      record.start_turns = seconds > 0 ? static_cast<float>(instance.start / seconds) : 0;
      record.turns_a_second =
          seconds > 0 ? static_cast<float>(static_cast<double>(instance.speed) / seconds) : 0;
      record.scene = scenes_[instance.role()];
    }
    add_top();
    build_ms_ = watch.milliseconds();
  }
  ~EmbreeSceneRays() override {
    if (top_ != nullptr) rtcReleaseScene(top_);
    for (RTCScene scene : scenes_) rtcReleaseScene(scene);
    rtcReleaseDevice(device_);
  }
  EmbreeSceneRays(const EmbreeSceneRays&) = delete;
  EmbreeSceneRays& operator=(const EmbreeSceneRays&) = delete;

  SceneHit trace(const QueryRay& ray, double time, RayAim aim) const override {
    TimedContext timed;
    rtcInitIntersectContext(&timed.context);
    timed.time = time;
    RTCRayHit query;
    query.ray = {ray.origin.x,
                 ray.origin.y,
                 ray.origin.z,
                 ray.t_min,
                 ray.direction.x,
                 ray.direction.y,
                 ray.direction.z,
                 0,
                 ray.t_max,
                 ~0u,
                 0,
                 0};
    if (aim == RayAim::kAny) {
      rtcOccluded1(top_, &timed.context, &query.ray);
      SceneHit hit;
      if (query.ray.tfar < 0) hit.t = 0, hit.instance = 0, hit.triangle = 0;
      return hit;
    }
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(top_, &timed.context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    const std::uint32_t instance = query.hit.instID[0];
    return {query.ray.tfar, instance,    query.hit.primID,
            query.hit.u,    query.hit.v, stage_.scene().labels[instance].id};
  }

  std::size_t bytes() const override {
    std::size_t sum = static_cast<std::size_t>(bytes_) + records_.size() * sizeof(InstanceRecord);
    for (const auto& pose : poses_) sum += pose.size() * sizeof(Vec3f);
    return sum;
  }
  double build_ms() const override { return build_ms_; }

 private:
  void add_role(const SceneRole& role) {
    const ModelView& model = ModelHandle::view(stage_.models()[role.model]);
    const Clip& clip = model.clips[role.clip];
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryTimeStepCount(geometry, clip.key_count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               model.triangles.data(), 0, sizeof(Triangle), model.triangles.size());
    PosedMesh mesh(model);
    for (std::uint32_t k = 0; k < clip.key_count; ++k) {
      mesh.set_time(at_key(clip.first_key + k));
      std::vector<Vec3f>& pose =
          poses_.emplace_back(mesh.positions().begin(), mesh.positions().end());
      pose.emplace_back();  // Embree loads sixteen bytes a vertex
      rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, k, RTC_FORMAT_FLOAT3,
                                 pose.data(), 0, sizeof(Vec3f), model.vertex_count);
    }
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    RTCScene scene = rtcNewScene(device_);
    scenes_.push_back(scene);
    rtcSetSceneFlags(scene, flags());
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    require_embree_success(device_);
  }

  void add_top() {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(records_.size()));
    rtcSetGeometryUserData(geometry, this);
    rtcSetGeometryBoundsFunction(
        geometry,
        [](const RTCBoundsFunctionArguments* args) {
          const auto& self = *static_cast<const EmbreeSceneRays*>(args->geometryUserPtr);
          const Aabb box = self.stage_.box_always(args->primID);
          *args->bounds_o = {box.lo.x, box.lo.y, box.lo.z, 0, box.hi.x, box.hi.y, box.hi.z, 0};
        },
        nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect);
    rtcSetGeometryOccludedFunction(geometry, occluded);
    rtcCommitGeometry(geometry);
    top_ = rtcNewScene(device_);
    rtcSetSceneFlags(top_, flags());
    rtcSetSceneBuildQuality(top_, RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometry(top_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(top_);
    require_embree_success(device_);
  }

  RTCSceneFlags flags() const {
    return mode_ == PeerMode::kRobust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE;
  }

  static void intersect(const RTCIntersectFunctionNArguments* args) {
    if (args->valid[0] == 0) return;
    const auto& self = *static_cast<const EmbreeSceneRays*>(args->geometryUserPtr);
    auto& outer = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    const InstanceRecord& record = self.records_[args->primID];
    RTCRayHit query;
    map_ray(record, outer.ray, reinterpret_cast<const TimedContext*>(args->context)->time,
            query.ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(record.scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return;
    outer.ray.tfar = query.ray.tfar;
    outer.hit = query.hit;
    outer.hit.instID[0] = args->primID;
  }

  static void occluded(const RTCOccludedFunctionNArguments* args) {
    if (args->valid[0] == 0) return;
    const auto& self = *static_cast<const EmbreeSceneRays*>(args->geometryUserPtr);
    auto& outer = *reinterpret_cast<RTCRay*>(args->ray);
    const InstanceRecord& record = self.records_[args->primID];
    RTCRay local;
    map_ray(record, outer, reinterpret_cast<const TimedContext*>(args->context)->time, local);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(record.scene, &context, &local);
    if (local.tfar < 0) outer.tfar = local.tfar;
  }

  static bool count_bytes(void* total, ssize_t bytes, bool) {
    *static_cast<std::atomic<ssize_t>*>(total) += bytes;
    return true;
  }

  const Stage& stage_;
  const PeerMode mode_;
  std::atomic<ssize_t> bytes_ = 0;  // outlives the device, which reports to it until the end
  RTCDevice device_;
  std::vector<std::vector<Vec3f>> poses_;
  std::vector<RTCScene> scenes_;  ///< by role
  std::vector<InstanceRecord> records_;
  RTCScene top_ = nullptr;
  double build_ms_ = 0;
};

}  // namespace

std::unique_ptr<PeerSceneRays> make_embree_scene_rays(const Stage& stage, PeerMode mode) {
  for (const SceneInstance& instance : stage.scene().instances)
    if (instance.has_path() || instance.wrap() != ClipWrap::kLoop) return nullptr;
  for (const SceneRole& role : stage.scene().roles)
    if (ModelHandle::view(stage.models()[role.model]).clips[role.clip].key_count > kMaxSteps)
      return nullptr;
  return std::make_unique<EmbreeSceneRays>(stage, mode);
}

}  // namespace mdk
#else
namespace mdk {
std::unique_ptr<PeerSceneRays> make_embree_scene_rays(const Stage&, PeerMode) { return nullptr; }
}  // namespace mdk
#endif
