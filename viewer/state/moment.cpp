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

std::uint32_t segment_of(const Model& model, const Moment& moment) {
  return moment.pose ? 0 : segment_of(model, moment.at);
}

}  // namespace mdk
