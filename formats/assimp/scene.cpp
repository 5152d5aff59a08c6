// The scene's nodes, axes and unit, and the order of the steps.
#include <cmath>
#include <cstdint>
#include <unordered_set>
#include <utility>

#include "formats/assimp/import.h"

namespace mdk {
namespace {

constexpr std::size_t kMaxNodes = std::size_t{1} << 20;
constexpr double kMetresPerCentimetre = 0.01;

/// Parents first, children in their order.
void list_nodes(SceneImport& import) {
  if (import.scene.mRootNode == nullptr) import.fail("holds no nodes");
  std::vector<const aiNode*> waiting = {import.scene.mRootNode};
  std::unordered_set<const aiNode*> seen;
  while (!waiting.empty()) {
    const aiNode* node = waiting.back();
    waiting.pop_back();
    if (!seen.insert(node).second)
      import.fail("the node " + quoted_name(node->mName) + " has two parents");
    if (import.nodes.size() == kMaxNodes)
      throw Error(ErrorCode::kOverLimit, import.path + ": has over a million nodes");
    import.node_numbers.try_emplace(node->mName.C_Str(), import.nodes.size());
    import.nodes.push_back(node);
    for (unsigned c = node->mNumChildren; c > 0; --c) waiting.push_back(node->mChildren[c - 1]);
  }
}

void set_place(const SceneImport& import, const aiNode& node, bool is_moved, Json& out) {
  const aiMatrix4x4& m = node.mTransformation;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column)
      if (!std::isfinite(m[row][column]))
        import.fail("the node " + quoted_name(node.mName) +
                    " has a place that is not a finite number");
  if (!is_moved) {
    if (m.IsIdentity()) return;
    out["matrix"] = columns_of(m);
    return;
  }
  aiVector3D scale, translation;
  aiQuaternion q;
  m.Decompose(scale, q, translation);
  const auto finite = [](float value) { return std::isfinite(value) ? value : 0.0f; };
  out["translation"] = {finite(translation.x), finite(translation.y), finite(translation.z)};
  out["rotation"] = {finite(q.x), finite(q.y), finite(q.z), finite(q.w)};
  out["scale"] = {finite(scale.x), finite(scale.y), finite(scale.z)};
}

/// What the scene's metadata says of a number, whatever its type.
double metadata_or(const aiScene& scene, const char* key, double fallback) {
  double precise = 0;
  float rough = 0;
  std::int32_t whole = 0;
  if (scene.mMetaData == nullptr) return fallback;
  if (scene.mMetaData->Get(key, precise)) return precise;
  if (scene.mMetaData->Get(key, rough)) return rough;
  if (scene.mMetaData->Get(key, whole)) return whole;
  return fallback;
}

/// An axis of the file, as `name` and its sign choose it.
aiVector3D axis(const aiScene& scene, const std::string& name, int fallback) {
  aiVector3D direction;
  const double number = metadata_or(scene, name.c_str(), fallback);
  if (!(number >= 0 && number <= 2)) return direction;
  direction[static_cast<unsigned>(number)] =
      metadata_or(scene, (name + "Sign").c_str(), 1) < 0 ? -1.0f : 1.0f;
  return direction;
}

/// From the file's axes and unit to +y up and metres. Assimp does so for all formats but FBX, whose
/// it only tells of.
aiMatrix4x4 world_from_root(SceneImport& import) {
  const aiScene& scene = import.scene;
  double unit = metadata_or(scene, "UnitScaleFactor", 1 / kMetresPerCentimetre);
  if (!(std::isfinite(unit) && unit > 0)) unit = 1;
  const aiVector3D right = axis(scene, "CoordAxis", 0), up = axis(scene, "UpAxis", 1),
                   front = axis(scene, "FrontAxis", 2);
  const auto metres = static_cast<float>(unit * kMetresPerCentimetre);
  aiMatrix4x4 world(right.x, right.y, right.z, 0, up.x, up.y, up.z, 0, front.x, front.y, front.z, 0,
                    0, 0, 0, 1);
  if (std::abs(world.Determinant() - 1) > 0.5f) {
    import.note("its axes make no right-handed system and are taken as +y up");
    world = aiMatrix4x4();
  }
  aiMatrix4x4 scale;
  return world * aiMatrix4x4::Scaling(aiVector3D(metres, metres, metres), scale);
}

void add_scene(SceneImport& import) {
  Json root = 0;
  if (const aiMatrix4x4 m = world_from_root(import); !m.IsIdentity()) {
    Json node = {{"name", "axes and unit"}, {"children", {0}}};
    node["matrix"] = columns_of(m);
    root = import.glb.add("nodes", std::move(node));
  }
  import.glb.add("scenes", {{ "nodes", { root } }});
}

}  // namespace

SceneGlb encode_scene(const aiScene& scene, const std::string& path) {
  SceneImport import(scene, path);
  list_nodes(import);
  add_materials(import);
  GeometryImport geometry(import);
  const std::vector<char> moved = moved_nodes(import);
  std::unordered_map<const aiNode*, std::size_t> numbers;
  for (std::size_t n = 0; n < import.nodes.size(); ++n) numbers[import.nodes[n]] = n;
  std::vector<std::size_t> target_counts;
  bool shows_something = false;
  for (std::size_t n = 0; n < import.nodes.size(); ++n) {
    const aiNode& node = *import.nodes[n];
    Json out = {{"name", node.mName.C_Str()}};
    set_place(import, node, moved[n] != 0, out);
    const ShownMesh shown = geometry.add(node);
    if (shown.mesh) out["mesh"] = *shown.mesh;
    if (shown.skin) out["skin"] = *shown.skin;
    for (unsigned c = 0; c < node.mNumChildren; ++c)
      out["children"].push_back(numbers.at(node.mChildren[c]));
    target_counts.push_back(shown.mesh ? geometry.target_count(node) : 0);
    shows_something |= shown.mesh.has_value();
    import.glb.add("nodes", std::move(out));
  }
  if (!shows_something) import.fail("holds no mesh of triangles; export one with the skeleton");
  add_animations(import, target_counts);
  add_scene(import);
  return {import.glb.finish(), std::move(import.notes)};
}

}  // namespace mdk
