#include "tests/formats/mdk/sample_model.h"

namespace mdk::test {
namespace {

constexpr std::uint32_t kKeys = 3;
constexpr std::uint32_t kTrianglesPerStrip[2] = {4, 2};
constexpr float kRise = 0.5f;  // of cluster 0, per key

/// Vertices of one strip zigzag between y = base and y = base + 1 along x, at z.
void append_strip_vertices(ModelStorage& model, float base, float z, std::uint32_t triangles) {
  for (std::uint32_t i = 0; i < triangles + 2; ++i) {
    model.poses.key_positions.push_back(
        {static_cast<float>(i / 2), base + static_cast<float>(i % 2), z});
  }
}

void add_geometry(ModelStorage& model) {
  model.vertex_count = kTrianglesPerStrip[0] + 2 + kTrianglesPerStrip[1] + 2;
  model.clips = {{"walk", 0, 2}, {"stánd", 2, 1}};
  model.key_times = {0.0, 0.25, 0.125};
  model.rest_key = 0;
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    append_strip_vertices(model, kRise * static_cast<float>(key), 0.0f, kTrianglesPerStrip[0]);
    append_strip_vertices(model, 4.0f, 2.0f, kTrianglesPerStrip[1]);
  }
  std::uint32_t first_vertex = 0;
  for (const std::uint32_t count : kTrianglesPerStrip) {
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t a = first_vertex + i;
      model.triangles.push_back(i % 2 == 0 ? Triangle{{a, a + 2, a + 1}}
                                           : Triangle{{a, a + 1, a + 2}});
    }
    first_vertex += count + 2;
  }
  model.source_triangles = {5, 4, 3, 2, 1, 0};
  model.bounds = {{0, 0, 0}, {2, 5, 2}};
  model.rest_diagonal = 5.744562646538029;
}

void add_clusters(ModelStorage& model) {
  // A segment per clip. In the second the trees are single leaves.
  model.segments = {{0, 1}, {2, 2}};
  model.clusters = {{0, 4}, {4, 2}};
  model.kd_nodes = {KdNode::inner(0, 1.0f, 1), KdNode::leaf(0, 3), KdNode::inner(1, 2.0f, 3),
                    KdNode::leaf(3, 2),        KdNode::leaf(5, 0), KdNode::leaf(0, 2),
                    KdNode::leaf(0, 4),        KdNode::leaf(0, 2)};
  model.kd_refs = {0, 1, 2, 2, 3, 4, 5, 0, 1, 2, 3, 4, 5};
  const Aabb rising{{0, 0, 0}, {2, 1, 0}}, still{{0, 4, 2}, {1, 5, 2}};
  model.fuzzy_trees = {
      {0, 5, 0, 5, rising}, {5, 1, 5, 2, still}, {6, 1, 7, 4, rising}, {7, 1, 11, 2, still}};
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    const float y = kRise * static_cast<float>(key);
    Affine3f back;
    back.m[1][3] = -y;
    model.local_from_world.push_back(back);
    model.local_from_world.push_back(Affine3f{});
    const Aabb risen{{0, y, 0}, {2, y + 1, 0}};
    const Aabb whole{risen.lo, {2, still.hi.y, still.hi.z}};
    model.key_boxes.push_back(whole);
    model.cluster_world_boxes.push_back(quantize_outward(risen, whole));
    model.cluster_world_boxes.push_back(quantize_outward(still, whole));
  }
  for (std::size_t c = 0; c < model.clusters.size(); ++c) {
    const Cluster& cluster = model.clusters[c];
    for (std::uint32_t i = 0; i < cluster.triangle_count; ++i) {
      Aabb box;
      for (const std::uint32_t v : model.triangles[cluster.first_triangle + i].v) {
        box.extend(model.poses.key_positions[v]);
      }
      model.fuzzy_boxes.push_back(quantize_outward(box, model.fuzzy_trees[c].local_box));
    }
  }
  const std::vector<QuantizedBox> first_segment = model.fuzzy_boxes;
  model.fuzzy_boxes.insert(model.fuzzy_boxes.end(), first_segment.begin(), first_segment.end());
}

void add_appearance(ModelStorage& model) {
  Appearance& look = model.appearance;
  Material plain;
  plain.flags = kMaterialFlatShaded;
  Material brick;
  brick.base_color[0] = 1.0f;
  brick.texture = 1;
  brick.flags = kMaterialUnlit;
  brick.wrap_u = TextureWrap::kMirror;
  brick.wrap_v = TextureWrap::kClamp;
  look.materials = {plain, brick};
  look.triangle_materials = {0, 1, 0, 1, 1, 1};
  look.textures = {{1, 1, 0}, {3, 2, 1}};
  look.texels = {0xff0000ffu, 0xff00ff00u, 0xffff0000u, 0xffffffffu, 0xff000000u, 0x80808080u, 7u};
  for (std::uint32_t corner = 0; corner < 3 * model.triangles.size(); ++corner) {
    look.corner_texcoords.push_back(
        {static_cast<float>(corner) / 4, 1.0f - static_cast<float>(corner)});
    look.corner_colors.push_back(0xff000000u + corner * 0x00010307u);
  }
}

/// Strip 0 rises half by its bone and half by a morph target; strip 1 hangs on a bone that rests.
Rig sample_rig(const ModelStorage& model) {
  Rig rig;
  rig.first_weight = rig.first_offset = {0};
  for (std::uint32_t v = 0; v < model.vertex_count; ++v) {
    rig.base_positions.push_back(model.poses.key_positions[v]);
    if (v < kTrianglesPerStrip[0] + 2) {
      rig.bone_weights.insert(rig.bone_weights.end(), {{0, 0.25f}, {2, 0.75f}});
      rig.morph_offsets.push_back({0, {0, kRise / 2, 0}});
    } else {
      rig.bone_weights.push_back({1, 1.0f});
    }
    rig.first_weight.push_back(static_cast<std::uint32_t>(rig.bone_weights.size()));
    rig.first_offset.push_back(static_cast<std::uint32_t>(rig.morph_offsets.size()));
  }
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    Affine3f half_way;
    half_way.m[1][3] = kRise / 2 * static_cast<float>(key);
    rig.bone_maps.insert(rig.bone_maps.end(), {half_way, Affine3f{}, half_way});
    rig.target_weights.push_back(static_cast<float>(key));
  }
  return rig;
}

/// Strip 0 has y in a bit, strip 1 has x in two bits and y in three; the rise is in the maps.
QuantizedPoses sample_quantized_poses(const ModelStorage& model) {
  const std::uint32_t first_of_strip_1 = kTrianglesPerStrip[0] + 2;
  QuantizedPoses poses;
  poses.error = {{1e-3, 5e-4}};
  poses.first_vertex = {0, first_of_strip_1, model.vertex_count};
  for (std::uint32_t v = 0; v < model.vertex_count; ++v)
    poses.rest_positions.push_back(
        v < first_of_strip_1 ? Vec3f{model.poses.key_positions[v].x, 0, 0} : Vec3f{0, 4, 2});
  for (std::uint32_t key = 0; key < kKeys; ++key) {
    QuantizedBlock rising{{}, {0, 1, 0}, {0, 1, 0}, 0, 64 * key};
    rising.world_from_local.m[1][3] = kRise * static_cast<float>(key);
    poses.blocks.push_back(rising);
    poses.blocks.push_back({{}, {0.5f, 0.25f, 0}, {2, 3, 0}, 0, 64 * key + 32});
    poses.words.push_back(0b10'10'10);
    poses.words.push_back(0b10010'00010'10000'00000);
  }
  poses.words.push_back(0);
  return poses;
}

}  // namespace

ModelStorage sample_model() {
  ModelStorage model;
  add_geometry(model);
  add_clusters(model);
  add_appearance(model);
  return model;
}

ModelStorage sample_rig_model() {
  ModelStorage model = sample_model();
  model.poses = {PoseKind::kRig, {}, sample_rig(model), {}};
  return model;
}

ModelStorage sample_quantized_model() {
  ModelStorage model = sample_model();
  model.poses = {PoseKind::kQuantized, {}, {}, sample_quantized_poses(model)};
  return model;
}

ModelStorage sample_skeleton_model() {
  ModelStorage model = sample_rig_model();
  model.segments = {{0, 2}};
  model.fuzzy_trees.resize(2);
  model.kd_nodes.resize(6);
  model.kd_refs.resize(7);
  model.fuzzy_boxes.resize(6);
  Joint root, tip;
  root.limit = 0.5f;
  root.name_bytes = 3;
  tip.parent = 0;
  tip.limit = 1.5f;
  tip.name_offset = 3;
  tip.name_bytes = 4;
  tip.parent_from_joint.m[1][3] = 1;
  tip.scale = {2, 2, 2};
  const std::string names = "hiptail";
  model.skeleton = {{root, tip}, {names.begin(), names.end()}, {{0, {}}, {1, {}}, {1, {}}}};
  model.cluster_bones = {{0, {}}, {2, {}}};
  return model;
}

ModelStorage copy_of(const ModelView& model) {
  ModelStorage copy;
  assign_model(copy, model);
  return copy;
}

}  // namespace mdk::test
