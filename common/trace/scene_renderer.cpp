#include "common/trace/scene_renderer.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <bit>
#include <optional>
#include <string>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "common/base/stopwatch.h"
#include "common/motion/model_handle.h"
#include "common/motion/posed_mesh.h"
#include "common/trace/instance_trees.h"

namespace mdk {
namespace {

constexpr std::size_t kTilesPerChunk = 16;

void check_request(const SceneRequest& request) {
  const auto refuse = [](bool refused, const std::string& sentence) {
    if (refused) throw Error(ErrorCode::kUsage, sentence);
  };
  refuse(request.width < 1 || request.height < 1 || request.width > kMaxImageSide ||
             request.height > kMaxImageSide,
         "an image of " + std::to_string(request.width) + "x" + std::to_string(request.height) +
             " pixels cannot be: sides go from 1 to " + std::to_string(kMaxImageSide));
  refuse(request.samples < 1 || request.samples > kMaxSamples,
         std::to_string(request.samples) + " samples per pixel cannot be: they go from 1 to " +
             std::to_string(kMaxSamples));
  refuse(!request.shutter.empty() && request.shutter.size() != request.samples,
         "a shutter needs a time for each sample");
  refuse(!is_scene_shading(request.shading), "scenes have no shading mode '" +
                                                 std::string(shading_id(request.shading)) +
                                                 "'; there are diffuse, normals and clusters");
}

/// Tiles along a Morton curve: those of a chunk are neighbours, and share instances.
std::vector<std::uint32_t> tile_order(std::uint32_t width, std::uint32_t height) {
  const std::uint32_t columns = (width + kTileSide - 1) / kTileSide,
                      rows = (height + kTileSide - 1) / kTileSide;
  const auto spread = [](std::uint32_t x) {
    x = (x | x << 8) & 0x00ff00ff;
    x = (x | x << 4) & 0x0f0f0f0f;
    x = (x | x << 2) & 0x33333333;
    return (x | x << 1) & 0x55555555;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> places;
  for (std::uint32_t y = 0; y < rows; ++y)
    for (std::uint32_t x = 0; x < columns; ++x)
      places.emplace_back(spread(x) | spread(y) << 1, y * columns + x);
  std::ranges::sort(places);
  std::vector<std::uint32_t> order;
  for (const auto& place : places) order.push_back(place.second);
  return order;
}

PinholeRays sample_rays(const SceneRequest& request, std::uint32_t i) {
  PinholeRays rays = make_pinhole_rays(request.camera, request.width, request.height);
  if (i == 0) return rays;
  const EvenPoint place(i);
  rays.corner = rays.corner + rays.du * static_cast<float>(place.x - 0.5) +
                rays.dv * static_cast<float>(place.y - 0.5);
  return rays;
}

}  // namespace

std::uint32_t SceneHits::instance(std::uint32_t x, std::uint32_t y) const {
  if (hits.triangle(x, y) == kNoHit) return kNoHit;
  const std::uint32_t columns = (hits.width() + kTileSide - 1) / kTileSide;
  return instances[std::size_t{y / kTileSide} * columns + x / kTileSide]
      .instance[y % kTileSide * kTileSide + x % kTileSide];
}

std::uint64_t count_mismatches(const SceneHits& a, const SceneHits& b) {
  std::uint64_t count = 0;
  for (std::uint32_t y = 0; y < a.hits.height(); ++y)
    for (std::uint32_t x = 0; x < a.hits.width(); ++x)
      if (a.hits.triangle(x, y) != b.hits.triangle(x, y) || a.instance(x, y) != b.instance(x, y) ||
          std::bit_cast<std::uint32_t>(a.hits.t(x, y)) !=
              std::bit_cast<std::uint32_t>(b.hits.t(x, y)))
        ++count;
  return count;
}

struct SceneRenderer::State {
  /// What a thread keeps between tiles.
  struct Worker {
    explicit Worker(InstancePool p)
        : pool(std::move(p)), scratch(std::make_unique<CrowdScratch>()) {}

    InstancePool pool;
    std::unique_ptr<CrowdScratch> scratch;
    CrowdCounters counters;
    std::uint64_t serial = 0;
    double trace_seconds = 0, shade_seconds = 0;
  };

  State(const Stage& s, const SceneOptions& o)
      : stage(s),
        options(o),
        models(make_models(s, o.cache_bytes / 2)),
        shader(s, models),
        workers([this] { return Worker(InstancePool(models, pool_bytes())); }) {}

  static std::vector<std::unique_ptr<CrowdModel>> make_models(const Stage& stage,
                                                              std::size_t pose_bytes) {
    std::vector<std::unique_ptr<CrowdModel>> models;
    for (const Model& model : stage.models())
      models.push_back(std::make_unique<CrowdModel>(ModelHandle::view(model),
                                                    pose_bytes / stage.models().size()));
    return models;
  }
  std::size_t pool_bytes() const {
    return options.cache_bytes / 2 / static_cast<std::size_t>(std::max(1, thread_count()));
  }

  const Stage& stage;
  const SceneOptions options;
  std::vector<std::unique_ptr<CrowdModel>> models;
  SceneShader shader;
  std::optional<InstanceTrees> trees;
  tbb::enumerable_thread_specific<Worker> workers;
  std::vector<std::uint32_t> order;
  std::uint32_t order_width = 0, order_height = 0;
  CrowdFrame frame;
  std::uint64_t serial = 0;
  SceneHits hits;
  Film film;
  SceneStats stats;

  RefittedInstances refitted;
  std::vector<BruteInstance> brute;
  std::vector<std::vector<TriangleBlock>> brute_blocks;  ///< by model
  std::vector<std::vector<Vec3f>> brute_positions;

  Worker& worker() {
    Worker& worker = workers.local();
    if (worker.serial != serial) {
      worker.serial = serial;
      worker.counters = {};
      worker.trace_seconds = worker.shade_seconds = 0;
      worker.pool.begin_frame(frame);
    }
    return worker;
  }

  void update() {
    Stopwatch watch;
    if (options.technique == SceneTechnique::kBruteForce) {
      pose_all();
    } else if (!trees) {
      trees.emplace(stage);
      stats.prebuild_ms += watch.lap() * 1e3;
    }
    if (options.technique == SceneTechnique::kRefit) {
      refitted.update(stage, models, frame.time);
      frame.refitted = &refitted;
    }
    stats.update_ms += watch.lap() * 1e3;
  }

  /// Every instance with all its vertices, for brute force.
  void pose_all() {
    brute.clear();
    brute_positions.clear();
    if (brute_blocks.empty())
      for (const auto& crowd : models) {
        const ModelView& model = crowd->model();
        std::vector<TriangleBlock>& blocks = brute_blocks.emplace_back();
        for (std::uint32_t t = 0; t < model.triangle_count(); ++t) {
          if (t % kBlockTriangles == 0) blocks.emplace_back();
          blocks.back().push(t, model.triangles[t]);
        }
        if (!blocks.empty()) blocks.back().pad();
      }
    for (std::uint32_t i = 0; i < stage.instance_count(); ++i) {
      if (!stage.is_shown(i, frame.time)) continue;
      PosedMesh mesh(stage.model_of(i));
      mesh.set_time(stage.key_interval(i, frame.time));
      brute_positions.emplace_back(mesh.positions().begin(), mesh.positions().end());
      brute.push_back({make_instance_rays(frame, i), brute_blocks[stage.role(i).model],
                       brute_positions.back().data()});
    }
  }

  CrowdView view() const {
    CrowdView v{};
    v.slack = static_cast<float>(ray_slack(trees->unevenness(), 1));
    const auto set_tree = [&](CrowdView::Tree& tree, std::span<const WideBvhNode> nodes) {
      tree.nodes = nodes;
      if (nodes.empty()) return;
      const Aabb bounds = nodes[0].box();
      tree.forms = make_frustum_forms(frame.rays, Affine3d(), bounds);
      float reach = 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        reach += std::max(std::abs(bounds.lo[axis] - frame.rays.origin[axis]),
                          std::abs(bounds.hi[axis] - frame.rays.origin[axis]));
      loosen(tree.forms, v.slack * reach);
    };
    set_tree(v.trees[0], trees->standing());
    set_tree(v.trees[1], trees->moving(frame.time));
    v.instances = stage.scene().instances.data();
    v.pixel_from_world = frame.pixel_from_world;
    v.columns = static_cast<float>(frame.width);
    v.rows = static_cast<float>(frame.height);
    return v;
  }

  void trace(const SceneRequest& request, std::uint32_t sample, bool shades) {
    frame = {.stage = &stage,
             .models = models,
             .time = request.shutter.empty() ? request.time : request.shutter[sample],
             .rays = sample_rays(request, sample),
             .pixel_from_world = {},
             .width = request.width,
             .height = request.height,
             .line_share = options.line_share,
             .refitted = nullptr};
    frame.pixel_from_world = make_pixel_from_world(frame.rays);
    ++serial;
    update();
    Stopwatch watch;
    const CrowdView seen = options.technique == SceneTechnique::kBruteForce ? CrowdView{} : view();
    stats.update_ms += watch.lap() * 1e3;
    if (order_width != request.width || order_height != request.height) {
      order = tile_order(request.width, request.height);
      order_width = request.width;
      order_height = request.height;
    }
    hits.hits.resize(request.width, request.height);
    hits.instances.resize(hits.hits.tile_count());
    // A tile is shaded as soon as it is traced: what was worked out of its instances is at hand.
    parallel_chunks(order.size(), kTilesPerChunk, [&](std::size_t begin, std::size_t end) {
      Worker& w = worker();
      Stopwatch of_tile;
      for (std::size_t i = begin; i < end; ++i) {
        trace_tile(order[i], seen, w, request.counting ? &w.counters : nullptr);
        w.trace_seconds += of_tile.lap();
        if (!shades) continue;
        shade_tile(order[i], w, request.shading);
        w.shade_seconds += of_tile.lap();
      }
      w.pool.leave();
    });
    const double both = watch.lap() * 1e3;
    double traced = 0, shaded = 0;
    for (const Worker& w : workers)
      if (w.serial == serial) {
        traced += w.trace_seconds;
        shaded += w.shade_seconds;
      }
    const double share = shades && traced + shaded > 0 ? shaded / (traced + shaded) : 0;
    stats.trace_ms += both * (1 - share);
    stats.shade_ms += both * share;
    for (const Worker& w : workers)
      if (w.serial == serial) {
        stats.counters += w.counters;
        stats.instances_posed += w.pool.instances_posed();
      }
    stats.rays += std::uint64_t{request.width} * request.height;
    stats.hits += count_hits(hits.hits);
  }

  void trace_tile(std::uint32_t t, const CrowdView& seen, Worker& w, CrowdCounters* counters) {
    const TileRays tile{&frame.rays, &frame.pixel_from_world, hits.hits.tile_left(t),
                        hits.hits.tile_top(t)};
    TileHits& to = hits.hits.tile(t);
    hits.hits.set_hit(
        t, options.technique != SceneTechnique::kBruteForce
               ? trace_crowd_tile(tile, seen, w.pool, *w.scratch, to, hits.instances[t], counters)
               : trace_crowd_brute(tile, brute, to, hits.instances[t]));
  }
  void shade_tile(std::uint32_t t, Worker& w, ShadingMode mode) {
    const std::uint32_t left = hits.hits.tile_left(t), top = hits.hits.tile_top(t);
    if (hits.hits.is_hit(t)) {
      shader.shade_tile(frame, mode, left, top, hits.hits.tile(t), hits.instances[t], w.pool, film);
    } else {
      film.put_background(left, top);
    }
  }
};

SceneRenderer::SceneRenderer(const Stage& stage, const SceneOptions& options)
    : state_(std::make_unique<State>(stage, options)) {}
SceneRenderer::~SceneRenderer() = default;

const SceneStats& SceneRenderer::trace(const SceneRequest& request) {
  check_request(request);
  state_->stats = {};
  state_->trace(request, 0, false);
  return state_->stats;
}

const SceneStats& SceneRenderer::render(const SceneRequest& request) {
  check_request(request);
  State& s = *state_;
  s.stats = {};
  s.film.begin(request.width, request.height, request.samples);
  for (std::uint32_t i = 0; i < request.samples; ++i) {
    s.trace(request, i, true);
  }
  const Stopwatch watch;
  s.film.develop();
  s.stats.shade_ms += watch.milliseconds();
  return s.stats;
}

std::span<const std::uint32_t> SceneRenderer::pixels() const { return state_->film.pixels(); }
const SceneHits& SceneRenderer::hits() const { return state_->hits; }
const SceneStats& SceneRenderer::stats() const { return state_->stats; }

std::size_t SceneRenderer::structure_bytes() const {
  std::size_t sum = (state_->trees ? state_->trees->bytes() : 0) + state_->refitted.bytes();
  for (const auto& model : state_->models) sum += model->structure_bytes();
  return sum;
}
std::size_t SceneRenderer::cache_bytes() const {
  std::size_t sum = 0;
  for (const auto& model : state_->models) sum += model->cache_bytes();
  for (const auto& worker : state_->workers) sum += worker.pool.bytes();
  return sum;
}

}  // namespace mdk
