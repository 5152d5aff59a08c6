#include "viewer/state/moment.h"

#include "common/math/affine_path.h"

namespace mdk {

PosedMesh mesh_at(const Model& model, const Moment& moment) {
  PosedMesh mesh(model);
  if (moment.pose)
    mesh.set_pose(*moment.pose);
  else
    mesh.set_time(moment.at);
  return mesh;
}

ClusterPlaces cluster_places(const Model& model, const Moment& moment) {
  ClusterPlaces places;
  const std::uint32_t clusters = model.cluster_count();
  if (moment.pose) {
    const PosedMesh mesh = mesh_at(model, moment);
    for (std::uint32_t c = 0; c < clusters; ++c) {
      places.local_from_world.push_back(mesh.cluster_map(c));
      places.world_boxes.push_back(mesh.cluster_box(c));
    }
    return places;
  }
  const KeyInterval& at = moment.at;
  for (std::uint32_t c = 0; c < clusters; ++c) {
    places.local_from_world.push_back(
        interpolate(model.key_maps(at.key0)[c], model.key_maps(at.key1)[c], at.s));
    places.world_boxes.push_back(cluster_world_box(model, c, at));
  }
  return places;
}

std::array<Vec3d, 3> corners_at(const Model& model, const Moment& moment, std::uint32_t triangle) {
  const Triangle& corners = model.triangles[triangle];
  std::array<Vec3d, 3> places;
  if (moment.pose) {
    const PosedMesh mesh = mesh_at(model, moment);
    for (std::size_t i = 0; i < 3; ++i) places[i] = to_double(mesh.positions()[corners.v[i]]);
    return places;
  }
  const KeyInterval& at = moment.at;
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexRange corner{corners.v[i], corners.v[i] + 1};
    Vec3f from, to;
    decode_pose(model, at.key0, corner, {&from, 1});
    decode_pose(model, at.key1, corner, {&to, 1});
    places[i] = to_double(at.key0 == at.key1 ? from : from + (to - from) * at.s);
  }
  return places;
}

std::uint32_t segment_of(const Model& model, const Moment& moment) {
  return moment.pose ? 0 : segment_of(model, moment.at);
}

}  // namespace mdk
