#include "common/trace/renderer.h"

#include <tbb/enumerable_thread_specific.h>

#include <map>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/stopwatch.h"

namespace mdk {
namespace {

void check_size(std::uint32_t width, std::uint32_t height) {
  if (width >= 1 && height >= 1 && width <= kMaxImageSide && height <= kMaxImageSide) return;
  throw Error(ErrorCode::kUsage,
              "an image of " + std::to_string(width) + "x" + std::to_string(height) +
                  " pixels cannot be: sides go from 1 to " + std::to_string(kMaxImageSide));
}

/// What a thread keeps between tiles.
struct Worker {
  TileScratch scratch;
  TraceCounters counters;
};

}  // namespace

struct Renderer::State {
  explicit State(const Model& m) : model(m), mesh(m), shader(m) {}

  const Model& model;
  PosedMesh mesh;
  Shader shader;
  std::map<std::string_view, std::unique_ptr<Technique>> techniques;
  const TechniqueInfo* present = nullptr;
  Technique* technique = nullptr;

  tbb::enumerable_thread_specific<Worker> workers;
  HitBuffer hits;
  std::vector<std::uint32_t> pixels;
  FrameStats stats;
};

Renderer::Renderer(const Model& model, std::string_view technique_id)
    : state_(std::make_unique<State>(model)) {
  set_technique(technique_id);
}
Renderer::~Renderer() = default;

void Renderer::set_technique(std::string_view id) {
  const TechniqueInfo& row = find_technique(id);
  std::unique_ptr<Technique>& technique = state_->techniques[row.id];
  if (technique == nullptr) technique = row.make(state_->model);
  state_->present = &row;
  state_->technique = technique.get();
}

std::string_view Renderer::technique_id() const { return state_->present->id; }

const FrameStats& Renderer::trace(const FrameRequest& request) {
  check_size(request.width, request.height);
  State& s = *state_;
  const PinholeRays rays = make_pinhole_rays(request.camera, request.width, request.height);
  s.stats = {};
  s.stats.rays = static_cast<std::uint64_t>(request.width) * request.height;

  Stopwatch watch;
  if (request.pose != nullptr) {
    s.mesh.set_pose(*request.pose);
  } else {
    s.mesh.set_time(request.at);
  }
  s.stats.pose_ms = watch.lap() * 1e3;
  s.technique->prebuild(s.mesh);
  s.stats.prebuild_ms = watch.lap() * 1e3;
  s.technique->update(s.mesh);
  s.technique->set_view(rays);
  s.stats.update_ms = watch.lap() * 1e3;

  s.hits.resize(request.width, request.height);
  const PixelFromWorld pixel_from_world = make_pixel_from_world(rays);
  const bool counting = request.counting == Counting::kOn;
  for (Worker& worker : s.workers) worker.counters = {};
  parallel_chunks(s.hits.tile_count(), 8, [&](std::size_t begin, std::size_t end) {
    Worker& worker = s.workers.local();
    for (std::size_t i = begin; i < end; ++i) {
      const TileRays tile{&rays, &pixel_from_world, s.hits.tile_left(i), s.hits.tile_top(i)};
      s.hits.tile(i).clear();
      s.technique->trace(tile, s.hits.tile(i), worker.scratch,
                         counting ? &worker.counters : nullptr);
    }
  });
  s.stats.trace_ms = watch.lap() * 1e3;
  for (const Worker& worker : s.workers) s.stats.counters += worker.counters;
  s.stats.hits = count_hits(s.hits);
  return s.stats;
}

const FrameStats& Renderer::render(const FrameRequest& request) {
  trace(request);
  State& s = *state_;
  const PinholeRays rays = make_pinhole_rays(request.camera, request.width, request.height);
  s.pixels.resize(static_cast<std::size_t>(request.width) * request.height);
  const Stopwatch watch;
  s.shader.shade(s.mesh, rays, s.hits, request.shading, s.pixels);
  s.stats.shade_ms = watch.milliseconds();
  return s.stats;
}

std::span<const std::uint32_t> Renderer::pixels() const { return state_->pixels; }
const HitBuffer& Renderer::hits() const { return state_->hits; }
const FrameStats& Renderer::stats() const { return state_->stats; }
std::size_t Renderer::structure_bytes() const { return state_->technique->structure_bytes(); }

}  // namespace mdk
