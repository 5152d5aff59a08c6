// One maker per technique; the table (technique_table.cpp) is their only caller.
#pragma once

#include <memory>

#include "common/trace/technique.h"

namespace mdk {

std::unique_ptr<Technique> make_auto(const Model& model);
std::unique_ptr<Technique> make_brute_force(const Model& model);
std::unique_ptr<Technique> make_decomp_refit(const Model& model);
std::unique_ptr<Technique> make_embree(const Model& model);         ///< only with MDK_HAVE_EMBREE
std::unique_ptr<Technique> make_embree_low(const Model& model);     ///< "
std::unique_ptr<Technique> make_embree_medium(const Model& model);  ///< "
std::unique_ptr<Technique> make_embree_refit(const Model& model);   ///< "
std::unique_ptr<Technique> make_fuzzy_bvh(const Model& model);
std::unique_ptr<Technique> make_fuzzy_kdtree(const Model& model);
std::unique_ptr<Technique> make_hybrid_bvh(const Model& model);
std::unique_ptr<Technique> make_rebuild_bvh(const Model& model);
std::unique_ptr<Technique> make_refit_bvh(const Model& model);
std::unique_ptr<Technique> make_static_kdtree(const Model& model);
std::unique_ptr<Technique> make_tsah_refit(const Model& model);

/// The triangles of a posed mesh as the kernels take them.
inline TriangleSoup soup_of(const PosedMesh& mesh) {
  return {mesh.model().triangles.data(), mesh.positions().data(), mesh.model().triangle_count()};
}

}  // namespace mdk
