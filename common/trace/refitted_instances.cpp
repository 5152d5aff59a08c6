#include "common/trace/refitted_instances.h"

#include <algorithm>
#include <cmath>

#include "common/base/parallel.h"
#include "common/motion/model_handle.h"
#include "common/trace/query_keys.h"

namespace mdk {
namespace {

// Of a model of one cluster that does not move: its basis is the model's.
const TopLinks kOneLeaf = [] {
  TopLinks links{};
  for (WideBvhChild& child : links.child) child = WideBvhChild::leaf(0);
  links.count = 1;
  return links;
}();
const Affine3f kIdentity;
constexpr std::uint8_t kIrregular = 0;  // so that the map is used as it is
constexpr Vec3f kOrigin{0, 0, 0};

}  // namespace

RefittedInstances::Refitted::Refitted(const WorldTree& topology, const VertexSource& source)
    : tree(topology, source) {
  const PosedScene& scene = tree.scene();
  root = {scene.nodes, scene.blocks, {}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float lo = scene.bounds.lo[axis], hi = scene.bounds.hi[axis];
    root.size[axis] = std::max(std::abs(lo), std::abs(hi));
    std::fill_n(boxes.bounds[2 * axis], kTopWidth, lo);
    std::fill_n(boxes.bounds[2 * axis + 1], kTopWidth, hi);
  }
  model = {.bounds = {{scene.bounds.lo[0], scene.bounds.lo[1], scene.bounds.lo[2]},
                      {scene.bounds.hi[0], scene.bounds.hi[1], scene.bounds.hi[2]}},
           .center = scene.center,
           .diagonal = scene.diagonal,
           .clusters = 1,
           .top_nodes = 1,
           .top_roots = 1,
           .key_boxes = &scene.bounds,
           .top_boxes = &boxes,
           .top_links = &kOneLeaf,
           .local_from_world = &kIdentity,
           .key_maps = nullptr,
           .map_kinds = &kIrregular,
           .local_centers = &kOrigin,
           .trees = &root,
           .poses = nullptr};
}

void RefittedInstances::update(const Stage& stage,
                               std::span<const std::unique_ptr<CrowdModel>> models, double time) {
  // Calls use(source) while the poses of a time are held.
  const auto with_source = [&](const CrowdModel& crowd, const KeyInterval& at, const auto& use) {
    const KeyPoses& poses = *crowd.tracer().rays().poses;
    use(poses.acquire(at));
    poses.release(at);
  };
  if (topologies_.empty())
    for (const auto& crowd : models) {
      const ModelView& model = crowd->model();
      const std::uint32_t* places = crowd->tracer().rays().poses->places();
      with_source(*crowd, at_key(model.rest_key), [&](const VertexSource& source) {
        topologies_.push_back(std::make_unique<WorldTree>(
            model, std::vector<std::uint32_t>(places, places + model.vertex_count), source));
      });
    }
  instances_.resize(stage.instance_count());
  parallel_chunks(instances_.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto instance = static_cast<std::uint32_t>(i);
      const std::uint32_t model = stage.role(instance).model;
      with_source(*models[model], stage.key_interval(instance, time),
                  [&](const VertexSource& source) {
                    instances_[i] = std::make_unique<Refitted>(*topologies_[model], source);
                  });
    }
  });
}

void RefittedInstances::replace(InstanceRays& rays) const {
  const std::uint32_t clusters = rays.model->clusters;
  for (const float*& edges : rays.edges)
    if (edges != nullptr) edges += clusters;  // those of all clusters
  rays.model = &instances_[rays.instance]->model;
  rays.segment = 0;
  // Of boxes there is one key; vertices are still between two.
  rays.at = at_key(0);
}

std::size_t RefittedInstances::bytes() const {
  std::size_t sum = 0;
  for (const auto& topology : topologies_) sum += topology->bytes();
  for (const auto& instance : instances_)
    if (instance != nullptr) sum += sizeof(Refitted) + instance->tree.bytes();
  return sum;
}

}  // namespace mdk
