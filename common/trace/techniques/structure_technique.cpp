#include "common/trace/techniques/structure_technique.h"

namespace mdk {
namespace {

Aabb bounds_of(const BvhView& tree) { return tree.nodes.empty() ? Aabb{} : tree.nodes[0].box(); }
Aabb bounds_of(const KdTreeView& tree) { return tree.bounds; }

/// No structure at all: what every other technique is judged by.
class BruteForceTechnique final : public StructureTechnique {
 public:
  using StructureTechnique::StructureTechnique;
  void update(const PosedMesh& mesh) override {
    mesh.positions();
    show(mesh);
  }

 private:
  std::size_t tree_bytes() const override { return 0; }
};

}  // namespace

void StructureTechnique::show(const PosedMesh& mesh) {
  scene_.triangles = model_.triangles.data();
  scene_.triangle_count = model_.triangle_count();
  scene_.positions = mesh.posed_so_far();
  scene_.mesh = &mesh;
}

/// Calls visit(level) for the trees that hold anything.
template <class Visit>
void StructureTechnique::for_each_level(const Visit& visit) {
  const auto visit_all = [&](auto* levels) {
    if (levels == nullptr) return;
    for (auto& cluster : levels->clusters)
      if (!cluster.tree.nodes.empty()) visit(cluster);
    if (!levels->top.tree.nodes.empty()) visit(levels->top);
  };
  visit_all(std::get_if<BvhLevels>(&scene_.structure));
  visit_all(std::get_if<KdLevels>(&scene_.structure));
}

void StructureTechnique::set_view(const PinholeRays& rays) {
  for_each_level([&](auto& level) {
    level.forms = make_frustum_forms(rays, level.local_from_world, bounds_of(level.tree));
  });
  projected_blocks_.begin_frame(scene_.blocks.size());
  scene_.projected_blocks = projected_blocks_.usable() ? &projected_blocks_ : nullptr;
}

void StructureTechnique::prepare_occlusion() {
  scene_.mesh->positions();  // beams come everywhere
  for_each_level([&](auto& level) {
    level.space = make_beam_space(level.local_from_world, bounds_of(level.tree), model_.bounds);
  });
  posed_blocks_.begin_frame(scene_.blocks.size());
  scene_.posed_blocks = posed_blocks_.usable() ? &posed_blocks_ : nullptr;
}

std::size_t StructureTechnique::structure_bytes() const {
  return tree_bytes() + projected_blocks_.bytes() + posed_blocks_.bytes();
}

std::unique_ptr<Technique> make_brute_force(const ModelView& model) {
  return std::make_unique<BruteForceTechnique>(model);
}

}  // namespace mdk
