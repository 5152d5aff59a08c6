// Embree as a peer: the field's best known kernels on the same triangles, in robust mode, with
// packets of coherent rays as wide as the machine takes. Its triangle test is another one, so its
// hits agree with brute force's in depth, not in every bit. Everything of Embree stays in this
// file.
#include <embree3/rtcore.h>

#include <atomic>
#include <limits>
#include <string>

#include "common/base/error.h"
#include "common/base/isa.h"
#include "common/trace/techniques/makers.h"
#include "common/trace/techniques/technique_chooser.h"

namespace mdk {
namespace {

/// How the hierarchy follows the pose.
enum class EmbreeMode { kRefit, kLow, kMedium };

/// No wider vectors than our own kernels may use. Threads are those of oneTBB, which both share.
std::string device_config() {
  const std::string_view isa = isa_in_use();
  if (isa == "sse4" || isa == "scalar") return "isa=sse4.2";
  if (isa == "avx2") return "isa=avx2";
  return "";
}

void require_success(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    throw Error(ErrorCode::kOverLimit, "Embree is out of memory for this model");
  throw Error(ErrorCode::kInternal, "Embree fails with its error " + std::to_string(error));
}

/// What a packet of N rays is made of: Embree has a type and a function for each N.
template <int N>
struct Packet;
template <>
struct Packet<4> {
  using RayHit = RTCRayHit4;
  static constexpr std::uint32_t kWidth = 2, kHeight = 2;
  static constexpr auto kIntersect = rtcIntersect4;
};
template <>
struct Packet<8> {
  using RayHit = RTCRayHit8;
  static constexpr std::uint32_t kWidth = 4, kHeight = 2;
  static constexpr auto kIntersect = rtcIntersect8;
};
template <>
struct Packet<16> {
  using RayHit = RTCRayHit16;
  static constexpr std::uint32_t kWidth = 4, kHeight = 4;
  static constexpr auto kIntersect = rtcIntersect16;
};

template <int N>
void trace_packets(RTCScene scene, const TileRays& tile, TileHits& hits) {
  using P = Packet<N>;
  alignas(64) typename P::RayHit packet;
  alignas(64) int valid[N];
  const PinholeRays& rays = *tile.rays;
  for (int i = 0; i < N; ++i) {
    valid[i] = -1;
    packet.ray.org_x[i] = rays.origin.x;
    packet.ray.org_y[i] = rays.origin.y;
    packet.ray.org_z[i] = rays.origin.z;
    packet.ray.tnear[i] = 0;
    packet.ray.time[i] = 0;
    packet.ray.mask[i] = ~0u;
    packet.ray.id[i] = 0;
    packet.ray.flags[i] = 0;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::uint32_t top = 0; top < kTileSide; top += P::kHeight)
    for (std::uint32_t left = 0; left < kTileSide; left += P::kWidth) {
      for (std::uint32_t i = 0; i < N; ++i) {
        const std::uint32_t x = tile.x + left + i % P::kWidth, y = tile.y + top + i / P::kWidth;
        const Vec3f direction =
            rays.direction(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        packet.ray.dir_x[i] = direction.x;
        packet.ray.dir_y[i] = direction.y;
        packet.ray.dir_z[i] = direction.z;
        packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
        packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      }
      P::kIntersect(valid, scene, &context, &packet);
      for (std::uint32_t i = 0; i < N; ++i) {
        if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
        const std::uint32_t pixel = (top + i / P::kWidth) * kTileSide + left + i % P::kWidth;
        hits.t[pixel] = packet.ray.tfar[i];
        hits.triangle[pixel] = packet.hit.primID[i];
        hits.written = true;
      }
    }
}

class EmbreeTechnique final : public Technique {
 public:
  EmbreeTechnique(const Model& model, EmbreeMode mode)
      : model_(model), mode_(mode), device_(rtcNewDevice(device_config().c_str())) {
    require_success(device_);
    rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
    const bool wide = rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED);
    const bool medium = rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED);
    trace_ = wide ? trace_packets<16> : medium ? trace_packets<8> : trace_packets<4>;
    make_scene();
  }
  ~EmbreeTechnique() override {
    rtcReleaseScene(scene_);
    rtcReleaseGeometry(geometry_);
    rtcReleaseDevice(device_);
  }
  EmbreeTechnique(const EmbreeTechnique&) = delete;
  EmbreeTechnique& operator=(const EmbreeTechnique&) = delete;

  void prebuild(const PosedMesh& mesh) override {
    if (mode_ != EmbreeMode::kRefit || built_) return;
    PosedMesh rest(mesh.model());
    rest.set_time(at_key(mesh.model().rest_key));
    update(rest);
  }
  void update(const PosedMesh& mesh) override {
    set_vertices(mesh.positions());
    rtcCommitGeometry(geometry_);
    rtcCommitScene(scene_);
    require_success(device_);
    built_ = true;
  }
  void trace(const TileRays& tile, TileHits& hits, TileScratch&, TraceCounters*) const override {
    trace_(scene_, tile, hits);
  }
  std::size_t structure_bytes() const override { return static_cast<std::size_t>(bytes_); }

 private:
  void make_scene() {
    geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               model_.triangles.data(), 0, sizeof(Triangle),
                               model_.triangles.size());
    const RTCBuildQuality quality = mode_ == EmbreeMode::kRefit ? RTC_BUILD_QUALITY_REFIT
                                    : mode_ == EmbreeMode::kLow ? RTC_BUILD_QUALITY_LOW
                                                                : RTC_BUILD_QUALITY_MEDIUM;
    rtcSetGeometryBuildQuality(geometry_, quality);
    scene_ = rtcNewScene(device_);
    // Refitting and fast rebuilding belong to dynamic scenes of low quality, whose geometries keep
    // hierarchies of their own; there is one geometry, so nothing is lost.
    const bool dynamic = mode_ != EmbreeMode::kMedium;
    rtcSetSceneFlags(
        scene_, dynamic ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene_, dynamic ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometry(scene_, geometry_);
    require_success(device_);
  }

  /// Embree loads 16 bytes per vertex: positions are shared where something stands behind the
  /// last one, and copied otherwise.
  void set_vertices(std::span<const Vec3f> positions) {
    const Vec3f* vertices = positions.data();
    const std::span<const Vec3f> stored = model_.poses.key_positions;
    const Vec3f* end = stored.data() + stored.size();
    const bool in_model = vertices >= stored.data() && vertices < end;
    if (!in_model || vertices + positions.size() == end) {
      padded_.resize(positions.size() + 1);
      std::copy(positions.begin(), positions.end(), padded_.begin());
      vertices = padded_.data();
    }
    rtcSetSharedGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, vertices, 0,
                               sizeof(Vec3f), positions.size());
    rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
  }

  static bool count_bytes(void* total, ssize_t bytes, bool) {
    *static_cast<std::atomic<ssize_t>*>(total) += bytes;
    return true;
  }

  const Model& model_;
  EmbreeMode mode_;
  std::atomic<ssize_t> bytes_ = 0;  // outlives the device, which reports to it until the end
  RTCDevice device_;
  RTCGeometry geometry_ = nullptr;
  RTCScene scene_ = nullptr;
  void (*trace_)(RTCScene, const TileRays&, TileHits&) = nullptr;
  std::vector<Vec3f> padded_;
  bool built_ = false;
};

}  // namespace

std::unique_ptr<Technique> make_embree_refit(const Model& model) {
  return std::make_unique<EmbreeTechnique>(model, EmbreeMode::kRefit);
}
std::unique_ptr<Technique> make_embree_low(const Model& model) {
  return std::make_unique<EmbreeTechnique>(model, EmbreeMode::kLow);
}
std::unique_ptr<Technique> make_embree_medium(const Model& model) {
  return std::make_unique<EmbreeTechnique>(model, EmbreeMode::kMedium);
}
std::unique_ptr<Technique> make_embree(const Model& model) {
  static constexpr TechniqueCandidate kModes[] = {{"embree-refit", make_embree_refit},
                                                  {"embree-low", make_embree_low},
                                                  {"embree-medium", make_embree_medium}};
  return std::make_unique<TechniqueChooser>(model, kModes);
}

}  // namespace mdk
