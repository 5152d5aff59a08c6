#include "common/trace/renderer.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <optional>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/stopwatch.h"
#include "common/trace/affine_copy.h"

namespace mdk {
namespace {

void check_request(const FrameRequest& request) {
  const auto refuse = [](bool refused, const std::string& sentence) {
    if (refused) throw Error(ErrorCode::kUsage, sentence);
  };
  const std::uint32_t width = request.width, height = request.height;
  refuse(width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide,
         "an image of " + std::to_string(width) + "x" + std::to_string(height) +
             " pixels cannot be: sides go from 1 to " + std::to_string(kMaxImageSide));
  refuse(request.samples < 1 || request.samples > kMaxSamples,
         std::to_string(request.samples) + " samples per pixel cannot be: they go from 1 to " +
             std::to_string(kMaxSamples));
  refuse(request.occlusion_rays > kMaxOcclusionRays,
         std::to_string(request.occlusion_rays) + " occlusion rays cannot be: they go from 0 to " +
             std::to_string(kMaxOcclusionRays));
  refuse(!request.shutter.empty() && request.shutter.size() != request.samples,
         "a shutter needs a moment for each sample");
  refuse(!request.shutter.empty() && request.shading == ShadingMode::kAffine,
         "the shading mode affine shows one moment: leave the shutter closed");
}

/// Sample `i` of every pixel: the centre first, then spread evenly over the pixel.
PinholeRays sample_rays(const FrameRequest& request, std::uint32_t i) {
  PinholeRays rays = make_pinhole_rays(request.camera, request.width, request.height);
  if (i == 0) return rays;
  const EvenPoint place(i);
  rays.corner = rays.corner + rays.du * static_cast<float>(place.x - 0.5) +
                rays.dv * static_cast<float>(place.y - 0.5);
  return rays;
}

/// What a thread keeps between tiles.
struct Worker {
  TileScratch scratch;
  TraceCounters counters;
};

}  // namespace

struct Renderer::State {
  explicit State(const ModelView& m) : model(m), mesh(m), shader(m) {}

  const ModelView& model;
  PosedMesh mesh;
  Shader shader;
  std::map<std::string_view, std::unique_ptr<Technique>> techniques;
  const TechniqueInfo* info = nullptr;
  Technique* technique = nullptr;

  tbb::enumerable_thread_specific<Worker> workers;
  HitBuffer hits;
  std::vector<TraceCounters> tile_work;
  Film film;
  HeatScale heat;
  FrameStats stats;
  double posing_seen = 0;  ///< of the mesh's posing_seconds(), in stats

  std::optional<AffineCopy> affine;          ///< once it was asked for
  std::unique_ptr<Renderer> affine_picture;  ///< of the copy
  bool shows_affine = false;                 ///< whether that is the last picture

  double without_posing(double seconds);
  void set_moment(const FrameRequest& request, std::uint32_t i);
  void pose(const FrameRequest& request, std::uint32_t i);
  void trace(const FrameRequest& request, const PinholeRays& rays);
  void shade(const FrameRequest& request, const PinholeRays& rays, std::uint32_t sample);
  const FrameStats& render_affine(const FrameRequest& request);

  /// Traces all tiles; `counters_of` tells where a tile's work is counted, if anywhere.
  template <class CountersOf>
  void trace_tiles(const PinholeRays& rays, const CountersOf& counters_of) {
    const PixelFromWorld pixel_from_world = make_pixel_from_world(rays);
    parallel_chunks(hits.tile_count(), 8, [&](std::size_t begin, std::size_t end) {
      Worker& worker = workers.local();
      for (std::size_t i = begin; i < end; ++i) {
        const TileRays tile{&rays, &pixel_from_world, hits.tile_left(i), hits.tile_top(i)};
        hits.set_hit(i,
                     technique->trace(tile, hits.tile(i), worker.scratch, counters_of(i, worker)));
      }
    });
  }
};

Renderer::Renderer(const ModelView& model, std::string_view technique_id)
    : state_(std::make_unique<State>(model)) {
  set_technique(technique_id);
}
Renderer::~Renderer() = default;

void Renderer::set_technique(std::string_view id) {
  const TechniqueInfo& row = find_technique(id);
  std::unique_ptr<Technique>& technique = state_->techniques[row.id];
  if (technique == nullptr) technique = row.make(state_->model);
  state_->info = &row;
  state_->technique = technique.get();
}

std::string_view Renderer::technique_id() const { return state_->info->id; }

/// Vertices are posed when they are first asked for: that counts as pose, wherever it happened.
/// Returns the rest, in milliseconds.
double Renderer::State::without_posing(double seconds) {
  const double posing = std::min(seconds, mesh.posing_seconds() - posing_seen);
  posing_seen = mesh.posing_seconds();
  stats.pose_ms += posing * 1e3;
  return (seconds - posing) * 1e3;
}

/// The mesh at the moment of sample `i`.
void Renderer::State::set_moment(const FrameRequest& request, std::uint32_t i) {
  if (request.pose != nullptr) {
    mesh.set_pose(*request.pose);
  } else {
    const KeyInterval& at = request.shutter.empty() ? request.at : request.shutter[i];
    if (at.key0 != at.key1 && !model.holds_between_keys)
      throw Error(ErrorCode::kUsage,
                  "the picture's time lies between keys, where the model's boxes do not hold: "
                  "render keys, or bake it with --between-keys on");
    mesh.set_time(at);
  }
}

/// The structure at that moment.
void Renderer::State::pose(const FrameRequest& request, std::uint32_t i) {
  Stopwatch watch;
  set_moment(request, i);
  stats.pose_ms += watch.lap() * 1e3;
  technique->prebuild(mesh);
  stats.prebuild_ms += without_posing(watch.lap());
  technique->update(mesh);
  stats.update_ms += without_posing(watch.lap());
}

void Renderer::State::trace(const FrameRequest& request, const PinholeRays& rays) {
  Stopwatch watch;
  technique->set_view(rays);
  stats.update_ms += watch.lap() * 1e3;
  hits.resize(request.width, request.height);
  for (Worker& worker : workers) worker.counters = {};
  const bool counting = request.counting == Counting::kOn;
  trace_tiles(rays,
              [&](std::size_t, Worker& worker) { return counting ? &worker.counters : nullptr; });
  stats.trace_ms += without_posing(watch.lap());
  for (const Worker& worker : workers) stats.counters += worker.counters;
  stats.rays += static_cast<std::uint64_t>(request.width) * request.height;
  stats.hits += count_hits(hits);
}

void Renderer::State::shade(const FrameRequest& request, const PinholeRays& rays,
                            std::uint32_t sample) {
  const Stopwatch watch;
  ShadingInput input{.mesh = mesh, .rays = rays, .hits = hits};
  Lighting lighting(*technique, rays, model.bounds);
  if (request.shading == ShadingMode::kLit) {
    technique->prepare_occlusion();
    lighting.choose_directions(request.occlusion_rays, sample);
    input.lighting = &lighting;
  }
  tile_work.clear();
  if (shows_work(request.shading)) {
    tile_work.resize(hits.tile_count());
    trace_tiles(rays, [&](std::size_t tile, Worker&) { return &tile_work[tile]; });
    input.tile_work = tile_work;
  }
  const ShadingReport report = shader.shade(input, request.shading, film);
  stats.light_rays += report.rays;
  heat = report.heat;
  stats.shade_ms += without_posing(watch.seconds());
}

/// Of the clusters' maps alone: another mesh, with a hierarchy of its own for this one picture.
const FrameStats& Renderer::State::render_affine(const FrameRequest& request) {
  const Stopwatch watch;
  set_moment(request, 0);
  if (!affine) affine.emplace(model);
  const ModelView& copy = affine->at(mesh);
  const double pose_ms = watch.milliseconds();
  if (affine_picture == nullptr) affine_picture = std::make_unique<Renderer>(copy, "rebuild-bvh");
  FrameRequest of_copy = request;
  of_copy.at = at_key(0);
  of_copy.pose = nullptr;
  of_copy.shading = ShadingMode::kDiffuse;
  stats = affine_picture->render(of_copy);
  stats.pose_ms += pose_ms;
  return stats;
}

const FrameStats& Renderer::trace(const FrameRequest& request) {
  check_request(request);
  state_->shows_affine = false;
  state_->stats = {};
  state_->pose(request, 0);
  state_->trace(request, sample_rays(request, 0));
  return state_->stats;
}

const FrameStats& Renderer::render(const FrameRequest& request) {
  check_request(request);
  State& s = *state_;
  s.stats = {};
  s.shows_affine = request.shading == ShadingMode::kAffine;
  if (s.shows_affine) return s.render_affine(request);
  s.film.begin(request.width, request.height, request.samples);
  for (std::uint32_t i = 0; i < request.samples; ++i) {
    if (i == 0 || !request.shutter.empty()) s.pose(request, i);
    const PinholeRays rays = sample_rays(request, i);
    s.trace(request, rays);
    s.shade(request, rays, i);
  }
  const Stopwatch watch;
  s.film.develop();
  s.stats.shade_ms += watch.milliseconds();
  return s.stats;
}

std::span<const std::uint32_t> Renderer::pixels() const {
  return state_->shows_affine ? state_->affine_picture->pixels() : state_->film.pixels();
}
const HitBuffer& Renderer::hits() const {
  return state_->shows_affine ? state_->affine_picture->hits() : state_->hits;
}
const HeatScale& Renderer::heat_scale() const { return state_->heat; }
std::span<const TraceCounters> Renderer::tile_work() const { return state_->tile_work; }
const FrameStats& Renderer::stats() const { return state_->stats; }
std::size_t Renderer::structure_bytes() const { return state_->technique->structure_bytes(); }
std::string Renderer::technique_note() const { return state_->technique->note(); }

std::vector<KeyInterval> shutter_moments(const ModelView& model, std::uint32_t clip, double seconds,
                                         double open, std::uint32_t samples) {
  std::vector<KeyInterval> moments;
  moments.reserve(samples);
  for (std::uint32_t i = 0; i < samples; ++i) {
    const double place = EvenPoint::fraction(0.5 + i / std::numbers::phi);
    moments.push_back(locate_time(model, clip, seconds + open * (place - 0.5)));
  }
  return moments;
}

}  // namespace mdk
