// What the parts of a frame cost, one by one: culling nodes, testing triangles, building,
// refitting, interpolating. Items per second are boxes, triangles or vertices. Run it alone on a
// quiet machine, e.g. bin/kernels_bench --benchmark_filter=Triangles.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "common/base/parallel.h"
#include "common/motion/posed_mesh.h"
#include "common/structures/kd_tree.h"
#include "common/structures/wide_bvh.h"
#include "common/trace/cluster_trees.h"
#include "common/trace/kernels/tile_kernels.h"

namespace mdk {
namespace {

constexpr std::uint32_t kImageSide = 1024;

/// A wavy sheet of 2 n^2 triangles that fills the picture, nearest at its centre, in two keys.
class Sheet {
 public:
  explicit Sheet(std::uint32_t n) {
    storage_.vertex_count = (n + 1) * (n + 1);
    storage_.clips = {{"wave", 0, 2}};
    storage_.key_times = {0, 1};
    for (int key = 0; key < 2; ++key)
      for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
          const float x = 2 * static_cast<float>(i) / static_cast<float>(n) - 1;
          const float y = 2 * static_cast<float>(j) / static_cast<float>(n) - 1;
          const float wave = 0.05f * std::sin(9 * x + static_cast<float>(key)) * std::cos(7 * y);
          storage_.poses.key_positions.push_back({x, y, wave - 0.2f * (x * x + y * y)});
        }
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t a = j * (n + 1) + i, b = a + n + 1;
        storage_.triangles.push_back({{a, a + 1, b}});
        storage_.triangles.push_back({{b, a + 1, b + 1}});
      }
    model_ = storage_.view();
    mesh_ = std::make_unique<PosedMesh>(model_);
    mesh_->set_time(at_key(0));
    boxes_.resize(model_.triangle_count());
    triangle_boxes(*mesh_, boxes_);
  }

  const ModelView& model() const { return model_; }
  PosedMesh& mesh() { return *mesh_; }
  const std::vector<Aabb>& boxes() const { return boxes_; }

 private:
  ModelStorage storage_;
  ModelView model_;
  std::unique_ptr<PosedMesh> mesh_;
  std::vector<Aabb> boxes_;
};

/// Traces every tile of the picture.
class Picture {
 public:
  Picture() : rays_(make_pinhole_rays(kCamera, kImageSide, kImageSide)) {
    pixel_from_world_ = make_pixel_from_world(rays_);
    hits_.resize(kImageSide, kImageSide);
  }

  void trace(const WideBvh& bvh, std::span<const TriangleBlock> blocks, const PosedMesh& mesh,
             ProjectionCache* cache) {
    TraceScene scene;
    scene.positions = mesh.positions().data();
    scene.blocks = blocks;
    scene.projected_blocks = cache;
    TreeLevel<BvhView>& top = scene.structure.emplace<BvhLevels>().top;
    top.tree = {bvh.nodes, 0};
    top.forms = make_frustum_forms(rays_, Affine3d{}, bvh.nodes[0].box());
    for (std::size_t i = 0; i < hits_.tile_count(); ++i) {
      const TileRays tile{&rays_, &pixel_from_world_, hits_.tile_left(i), hits_.tile_top(i)};
      hits_.set_hit(i, trace_tile(tile, scene, hits_.tile(i), scratch_, nullptr));
    }
    benchmark::DoNotOptimize(hits_.tile(0).t[0]);
  }

 private:
  static constexpr Camera kCamera{.eye = {0, 0, 2}, .target = {0, 0, 0}, .vertical_fov_deg = 50};
  PinholeRays rays_;
  PixelFromWorld pixel_from_world_;
  HitBuffer hits_;
  TileScratch scratch_;
};

std::int64_t items(const benchmark::State& state, std::size_t per_iteration) {
  return static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(per_iteration);
}

/// Leaves without triangles: what is left is culling.
void NodeCulling(benchmark::State& state) {
  const ThreadLimit one(1);
  Sheet sheet(static_cast<std::uint32_t>(state.range(0)));
  const WideBvh bvh = build_wide_bvh(sheet.boxes(), 16);
  const std::vector<TriangleBlock> blocks(bvh.leaf_count());
  Picture picture;
  for (auto _ : state) picture.trace(bvh, blocks, sheet.mesh(), nullptr);
  state.SetItemsProcessed(items(state, sheet.boxes().size()));
}
BENCHMARK(NodeCulling)->Arg(90)->Arg(350)->Unit(benchmark::kMillisecond);

/// A whole picture; sheets of 90, 350 and 900 have triangles of 65, 4 and 0.6 pixels.
void Triangles(benchmark::State& state, bool keep) {
  const ThreadLimit one(1);
  Sheet sheet(static_cast<std::uint32_t>(state.range(0)));
  const WideBvh bvh = build_wide_bvh(sheet.boxes(), 16);
  std::vector<TriangleBlock> blocks;
  append_blocks(bvh, sheet.model().triangles, 0, blocks);
  ProjectionCache cache;
  Picture picture;
  for (auto _ : state) {
    cache.begin_frame(blocks.size());
    picture.trace(bvh, blocks, sheet.mesh(), keep ? &cache : nullptr);
  }
  state.SetItemsProcessed(items(state, sheet.boxes().size()));
}
BENCHMARK_CAPTURE(Triangles, projected_per_frame, true)
    ->Arg(90)
    ->Arg(350)
    ->Arg(900)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Triangles, projected_per_tile, false)
    ->Arg(90)
    ->Arg(350)
    ->Arg(900)
    ->Unit(benchmark::kMillisecond);

void BuildWideBvh(benchmark::State& state) {
  const ThreadLimit threads(static_cast<int>(state.range(1)));
  const Sheet sheet(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(build_wide_bvh(sheet.boxes(), 16));
  state.SetItemsProcessed(items(state, sheet.boxes().size()));
}
BENCHMARK(BuildWideBvh)
    ->ArgsProduct({{90, 350, 900}, {1, 2}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

void BuildKdTree(benchmark::State& state) {
  const ThreadLimit one(1);
  const Sheet sheet(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(build_kd_tree(sheet.boxes()));
  state.SetItemsProcessed(items(state, sheet.boxes().size()));
}
BENCHMARK(BuildKdTree)->Arg(90)->Unit(benchmark::kMillisecond);

void RefitWideBvh(benchmark::State& state) {
  const ThreadLimit one(1);
  const Sheet sheet(static_cast<std::uint32_t>(state.range(0)));
  WideBvh bvh = build_wide_bvh(sheet.boxes(), 16);
  for (auto _ : state) refit_wide_bvh(bvh, sheet.boxes());
  state.SetItemsProcessed(items(state, sheet.boxes().size()));
}
BENCHMARK(RefitWideBvh)->Arg(90)->Arg(350)->Unit(benchmark::kMicrosecond);

void TriangleBoxes(benchmark::State& state) {
  const ThreadLimit one(1);
  Sheet sheet(static_cast<std::uint32_t>(state.range(0)));
  std::vector<Aabb> boxes(sheet.boxes().size());
  for (auto _ : state) triangle_boxes(sheet.mesh(), boxes);
  state.SetItemsProcessed(items(state, boxes.size()));
}
BENCHMARK(TriangleBoxes)->Arg(90)->Arg(350)->Unit(benchmark::kMicrosecond);

void InterpolatePositions(benchmark::State& state) {
  const ThreadLimit one(1);
  Sheet sheet(static_cast<std::uint32_t>(state.range(0)));
  for (auto _ : state) {
    sheet.mesh().set_time({0, 1, 0.4f});
    benchmark::DoNotOptimize(sheet.mesh().positions().data());
  }
  state.SetItemsProcessed(items(state, sheet.model().vertex_count));
}
BENCHMARK(InterpolatePositions)->Arg(90)->Arg(350)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace mdk
