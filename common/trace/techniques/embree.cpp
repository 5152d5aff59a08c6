// Embree as a peer: the field's best known kernels on the same triangles, in robust mode. A tile is
// a stream of sixteen coherent packets of sixteen rays, which Embree takes at once and culls
// together: of all it offers, this measures fastest (docs/kernels.md, Embree). Its triangle test is
// another one, so its hits agree with brute force's in depth, not in every bit. Everything of
// Embree stays in this file and embree_rays.cpp.
#include <embree3/rtcore.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "common/trace/techniques/embree_device.h"
#include "common/trace/techniques/structure_technique.h"
#include "common/trace/techniques/technique_chooser.h"

namespace mdk {
namespace {

/// How the hierarchy follows the pose.
enum class EmbreeMode { kRefit, kLow, kMedium };

constexpr std::uint32_t kWidth = 16;                      // rays of a packet
constexpr std::uint32_t kPackets = kTilePixels / kWidth;  // of a tile
constexpr std::uint32_t kSide = 4;                        // of a packet's square of pixels
constexpr std::uint32_t kSquaresPerRow = kTileSide / kSide;
static_assert(kSide * kSide == kWidth && kSquaresPerRow * kSquaresPerRow == kPackets);

/// A tile's rays as Embree wants them: 4x4 pixels a packet, packets row by row. What no ray of a
/// picture changes is written once.
class TilePackets {
 public:
  TilePackets() {
    for (RTCRayHit16& packet : packets_)
      for (std::uint32_t i = 0; i < kWidth; ++i) {
        packet.ray.tnear[i] = 0;
        packet.ray.time[i] = 0;
        packet.ray.mask[i] = ~0u;
        packet.ray.id[i] = 0;
        packet.ray.flags[i] = 0;
        packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      }
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      column_[i] = static_cast<float>(i % kSide) + 0.5f;
      row_[i] = static_cast<float>(i / kSide) + 0.5f;
    }
  }

  bool trace(RTCScene scene, const TileRays& tile, TileHits& hits) {
    if (!(tile.rays->origin == origin_)) set_origin(tile.rays->origin);
    for (std::uint32_t p = 0; p < kPackets; ++p) aim(packets_[p], tile, p);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersectNM(scene, &context, reinterpret_cast<RTCRayHitN*>(packets_), kWidth, kPackets,
                   sizeof(RTCRayHit16));
    std::uint32_t found = 0;  // the only geometry is number 0
    for (const RTCRayHit16& packet : packets_)
      for (const unsigned geometry : packet.hit.geomID) found += geometry == 0;
    if (found == 0) return false;
    for (std::uint32_t p = 0; p < kPackets; ++p) read_back(packets_[p], p, hits);
    return true;
  }

 private:
  void set_origin(const Vec3f& origin) {
    origin_ = origin;
    for (RTCRayHit16& packet : packets_)
      for (std::uint32_t i = 0; i < kWidth; ++i) {
        packet.ray.org_x[i] = origin.x;
        packet.ray.org_y[i] = origin.y;
        packet.ray.org_z[i] = origin.z;
      }
  }

  void aim(RTCRayHit16& packet, const TileRays& tile, std::uint32_t p) const {
    const PinholeRays& rays = *tile.rays;
    const auto left = static_cast<float>(tile.x + p % kSquaresPerRow * kSide);
    const auto top = static_cast<float>(tile.y + p / kSquaresPerRow * kSide);
    const auto fill = [&](float* out, float corner, float du, float dv) {
      for (std::uint32_t i = 0; i < kWidth; ++i)
        out[i] = corner + du * (left + column_[i]) + dv * (top + row_[i]);
    };
    fill(packet.ray.dir_x, rays.corner.x, rays.du.x, rays.dv.x);
    fill(packet.ray.dir_y, rays.corner.y, rays.du.y, rays.dv.y);
    fill(packet.ray.dir_z, rays.corner.z, rays.du.z, rays.dv.z);
    std::fill_n(packet.ray.tfar, kWidth, std::numeric_limits<float>::infinity());
    std::fill_n(packet.hit.geomID, kWidth, RTC_INVALID_GEOMETRY_ID);
  }

  static void read_back(const RTCRayHit16& packet, std::uint32_t p, TileHits& hits) {
    const std::uint32_t first = p / kSquaresPerRow * kSide * kTileSide + p % kSquaresPerRow * kSide;
    for (std::uint32_t row = 0; row < kSide; ++row)
      for (std::uint32_t column = 0; column < kSide; ++column) {
        const std::uint32_t i = row * kSide + column, pixel = first + row * kTileSide + column;
        hits.t[pixel] = packet.ray.tfar[i];
        hits.triangle[pixel] = packet.hit.geomID[i] == 0 ? packet.hit.primID[i] : kNoHit;
      }
  }

  alignas(64) RTCRayHit16 packets_[kPackets];
  float column_[kWidth], row_[kWidth];
  Vec3f origin_{std::numeric_limits<float>::quiet_NaN(), 0, 0};
};

/// The part of the image a box may be seen in, in pixels.
struct ImageBounds {
  float left, right, top, bottom;

  bool overlaps(const TileRays& tile) const {
    const auto x = static_cast<float>(tile.x), y = static_cast<float>(tile.y);
    return x <= right && x + kTileSide >= left && y <= bottom && y + kTileSide >= top;
  }
};

/// All of the image where the box reaches behind the eye.
ImageBounds image_bounds(const RTCBounds& box, const PinholeRays& rays) {
  constexpr float kInfinite = std::numeric_limits<float>::infinity();
  constexpr float kRounding = 1;  // pixels, far more than it can be
  const PixelFromWorld map = make_pixel_from_world(rays);
  const float x[] = {box.lower_x, box.upper_x}, y[] = {box.lower_y, box.upper_y},
              z[] = {box.lower_z, box.upper_z};
  ImageBounds bounds{kInfinite, -kInfinite, kInfinite, -kInfinite};
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f v = Vec3f{x[corner & 1], y[corner >> 1 & 1], z[corner >> 2]} - map.origin;
    const auto row = [&](const float* m) { return m[0] * v.x + m[1] * v.y + m[2] * v.z; };
    const float depth = row(map.m[2]);
    if (!(depth > 0)) return {-kInfinite, kInfinite, -kInfinite, kInfinite};
    const float across = row(map.m[0]) / depth, down = row(map.m[1]) / depth;
    bounds = {std::min(bounds.left, across - kRounding), std::max(bounds.right, across + kRounding),
              std::min(bounds.top, down - kRounding), std::max(bounds.bottom, down + kRounding)};
  }
  return bounds;
}

/// The rays of a beam as Embree wants them: the sixteen of a group are a packet, all packets a
/// stream of one direction.
class BeamPackets {
 public:
  BeamPackets() {
    for (RTCRay16& packet : packets_)
      for (std::uint32_t i = 0; i < kWidth; ++i) {
        packet.time[i] = 0;
        packet.mask[i] = ~0u;
        packet.id[i] = 0;
        packet.flags[i] = 0;
      }
  }

  void occlude(RTCScene scene, RayBeam& beam) {
    static_assert(kWidth == kBeamGroup && kPackets == kBeamGroups);
    const std::uint32_t packets = (beam.count + kWidth - 1) / kWidth;
    for (std::uint32_t p = 0; p < packets; ++p) aim(packets_[p], beam, p * kWidth);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcOccludedNM(scene, &context, reinterpret_cast<RTCRayN*>(packets_), kWidth, packets,
                  sizeof(RTCRay16));
    for (std::uint32_t p = 0; p < packets; ++p) {
      std::uint32_t bits = 0;
      for (std::uint32_t i = 0; i < kWidth; ++i)
        bits |= static_cast<std::uint32_t>(packets_[p].tfar[i] < 0) << i;
      const std::uint32_t rays = std::min(kWidth, beam.count - p * kWidth);
      beam.occluded[p] = static_cast<std::uint16_t>(bits & ((1u << rays) - 1u));
    }
  }

 private:
  static void aim(RTCRay16& packet, const RayBeam& beam, std::uint32_t first) {
    const BeamBasis& basis = beam.basis;
    const float unit = 1 / dot(basis.axis[2], basis.axis[2]);
    const Vec3f across = basis.axis[0] * unit, down = basis.axis[1] * unit,
                along = basis.axis[2] * unit;
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      const std::uint32_t ray = std::min(first + i, beam.count - 1);
      const float u = beam.u[ray], v = beam.v[ray], w = beam.w[ray];
      const Vec3f origin = basis.origin + (across * u + down * v + along * w);
      const bool sound = is_sound(origin);
      packet.org_x[i] = sound ? origin.x : 0;
      packet.org_y[i] = sound ? origin.y : 0;
      packet.org_z[i] = sound ? origin.z : 0;
      packet.dir_x[i] = basis.axis[2].x;
      packet.dir_y[i] = basis.axis[2].y;
      packet.dir_z[i] = basis.axis[2].z;
      packet.tnear[i] = sound ? 0.0f : 1.0f;  // a ray that ends before it starts is left out
      packet.tfar[i] = sound ? std::numeric_limits<float>::infinity() : 0.0f;
    }
  }

  /// Damaged files have surfaces anywhere; Embree's assertions end the program where its own
  /// bounds of coordinates are passed.
  static bool is_sound(const Vec3f& origin) {
    constexpr float kLargest = 1e18f;
    return std::abs(origin.x) <= kLargest && std::abs(origin.y) <= kLargest &&
           std::abs(origin.z) <= kLargest;
  }

  alignas(64) RTCRay16 packets_[kPackets];
};

class EmbreeTechnique final : public Technique {
 public:
  EmbreeTechnique(const ModelView& model, EmbreeMode mode)
      : model_(model), mode_(mode), device_(rtcNewDevice(embree_device_config().c_str())) {
    require_embree_success(device_);
    rtcSetDeviceMemoryMonitorFunction(device_, count_bytes, &bytes_);
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
    require_embree_success(device_);
    built_ = true;
  }
  void set_view(const PinholeRays& rays) override {
    RTCBounds box;
    rtcGetSceneBounds(scene_, &box);
    bounds_ = image_bounds(box, rays);
  }
  bool trace(const TileRays& tile, TileHits& hits, TileScratch&, TraceCounters*) const override {
    return bounds_.overlaps(tile) && packets_.local().trace(scene_, tile, hits);
  }
  void occlude(RayBeam& beam, TileScratch&) const override {
    beam_packets_.local().occlude(scene_, beam);
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
    require_embree_success(device_);
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

  const ModelView& model_;
  EmbreeMode mode_;
  std::atomic<ssize_t> bytes_ = 0;  // outlives the device, which reports to it until the end
  RTCDevice device_;
  RTCGeometry geometry_ = nullptr;
  RTCScene scene_ = nullptr;
  ImageBounds bounds_{};
  mutable tbb::enumerable_thread_specific<TilePackets> packets_;
  mutable tbb::enumerable_thread_specific<BeamPackets> beam_packets_;
  std::vector<Vec3f> padded_;
  bool built_ = false;
};

}  // namespace

std::unique_ptr<Technique> make_embree_refit(const ModelView& model) {
  return std::make_unique<EmbreeTechnique>(model, EmbreeMode::kRefit);
}
std::unique_ptr<Technique> make_embree_low(const ModelView& model) {
  return std::make_unique<EmbreeTechnique>(model, EmbreeMode::kLow);
}
std::unique_ptr<Technique> make_embree_medium(const ModelView& model) {
  return std::make_unique<EmbreeTechnique>(model, EmbreeMode::kMedium);
}
std::unique_ptr<Technique> make_embree(const ModelView& model) {
  static constexpr TechniqueCandidate kModes[] = {{"embree-refit", make_embree_refit},
                                                  {"embree-low", make_embree_low},
                                                  {"embree-medium", make_embree_medium}};
  return std::make_unique<TechniqueChooser>(model, kModes);
}

}  // namespace mdk
