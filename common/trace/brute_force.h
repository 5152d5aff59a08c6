// The closest hit among all triangles, with no structure at all: what RayQuery is judged by.
#pragma once

#include "common/motion/model.h"
#include "common/motion/posed_mesh.h"
#include "mdk/ray_query.h"

namespace mdk {

QueryHit brute_force_closest_hit(const ModelView& model, const QueryRay& ray,
                                 const KeyInterval& at);
/// The same for a mesh that is posed already, by hand or at a moment.
QueryHit brute_force_closest_hit(const PosedMesh& mesh, const QueryRay& ray);

}  // namespace mdk
