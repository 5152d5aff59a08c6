#include "tests/formats/model_copy.h"

namespace mdk::test {

ModelStorage copy_of(const Model& model) {
  ModelStorage copy;
  copy.vertex_count = model.vertex_count;
  copy.rest_key = model.rest_key;
  copy.bounds = model.bounds;
  copy.rest_diagonal = model.rest_diagonal;
  const auto copy_list = [](auto& to, auto from) { to.assign(from.begin(), from.end()); };
  copy_list(copy.clips, model.clips);
  copy_list(copy.key_times, model.key_times);
  copy.poses.kind = model.poses.kind;
  copy_list(copy.poses.key_positions, model.poses.key_positions);
  copy_list(copy.poses.rig.base_positions, model.poses.rig.base_positions);
  copy_list(copy.poses.rig.first_weight, model.poses.rig.first_weight);
  copy_list(copy.poses.rig.bone_weights, model.poses.rig.bone_weights);
  copy_list(copy.poses.rig.first_offset, model.poses.rig.first_offset);
  copy_list(copy.poses.rig.morph_offsets, model.poses.rig.morph_offsets);
  copy_list(copy.poses.rig.bone_maps, model.poses.rig.bone_maps);
  copy_list(copy.poses.rig.target_weights, model.poses.rig.target_weights);
  copy_list(copy.poses.quantized.error, model.poses.quantized.error);
  copy_list(copy.poses.quantized.first_vertex, model.poses.quantized.first_vertex);
  copy_list(copy.poses.quantized.rest_positions, model.poses.quantized.rest_positions);
  copy_list(copy.poses.quantized.blocks, model.poses.quantized.blocks);
  copy_list(copy.poses.quantized.words, model.poses.quantized.words);
  copy_list(copy.triangles, model.triangles);
  copy_list(copy.source_triangles, model.source_triangles);
  copy_list(copy.clusters, model.clusters);
  copy_list(copy.local_from_world, model.local_from_world);
  copy_list(copy.key_boxes, model.key_boxes);
  copy_list(copy.cluster_world_boxes, model.cluster_world_boxes);
  copy_list(copy.skeleton.joints, model.skeleton.joints);
  copy_list(copy.skeleton.names, model.skeleton.names);
  copy_list(copy.skeleton.bones, model.skeleton.bones);
  copy_list(copy.cluster_bones, model.cluster_bones);
  copy_list(copy.segments, model.segments);
  copy_list(copy.fuzzy_trees, model.fuzzy_trees);
  copy_list(copy.fuzzy_boxes, model.fuzzy_boxes);
  copy_list(copy.kd_nodes, model.kd_nodes);
  copy_list(copy.kd_refs, model.kd_refs);
  copy_list(copy.appearance.materials, model.materials);
  copy_list(copy.appearance.triangle_materials, model.triangle_materials);
  copy_list(copy.appearance.corner_texcoords, model.corner_texcoords);
  copy_list(copy.appearance.corner_colors, model.corner_colors);
  copy_list(copy.appearance.textures, model.textures);
  copy_list(copy.appearance.texels, model.texels);
  return copy;
}

}  // namespace mdk::test
