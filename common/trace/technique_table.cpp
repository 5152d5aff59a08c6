#include <string>

#include "common/base/error.h"
#include "common/structures/kd_tree.h"
#include "common/trace/technique.h"
#include "common/trace/techniques/structure_technique.h"
#include "common/trace/techniques/technique_chooser.h"

namespace mdk {
namespace {

/// Whichever of ours measures cheapest on this model, view and machine.
std::unique_ptr<Technique> make_auto(const ModelView& model) {
  // Most likely best first; those that build anew in every frame are left out: where that could
  // pay, hybrid-bvh does it when it does.
  static constexpr TechniqueCandidate kCandidates[] = {{"fuzzy-bvh", make_fuzzy_bvh},
                                                       {"refit-bvh", make_refit_bvh},
                                                       {"tsah-refit", make_tsah_refit},
                                                       {"hybrid-bvh", make_hybrid_bvh}};
  return std::make_unique<TechniqueChooser>(model, kCandidates);
}

}  // namespace

std::span<const TechniqueInfo> technique_table() {
  static constexpr TechniqueInfo kTable[] = {
      {"fuzzy-bvh", "Fuzzy BVH", "motion clusters, one hierarchy each for all poses", "Lo09 §4.3",
       make_fuzzy_bvh},
      {"fuzzy-kdtree", "Fuzzy kd-tree", "motion clusters, one kd-tree each for all poses", "GFW06",
       make_fuzzy_kdtree, TechniqueKind::kStructure, kKdTestCost},
      {"static-kdtree", "Static kd-tree", "a kd-tree built ahead for every key", "GFW06 Table 1",
       make_static_kdtree, TechniqueKind::kStructure, kKdTestCost},
      {"rebuild-bvh", "Rebuilt BVH", "binned SAH hierarchy, built anew every frame", "Lo09 §4.1",
       make_rebuild_bvh},
      {"refit-bvh", "Refitted BVH", "hierarchy of the rest pose, boxes refitted every frame",
       "Lo09 §4.2", make_refit_bvh},
      {"tsah-refit", "T-SAH, refitted", "hierarchy built for several poses at once, refitted",
       "Bittner and Meister 2015", make_tsah_refit},
      {"hybrid-bvh", "Hybrid BVH", "refitted until motion has worn it out, then built anew",
       "Lo09 §5.4", make_hybrid_bvh, TechniqueKind::kHistory},
      {"rotate-bvh", "Rotated BVH", "refitted, mended by tree rotations", "Kensler 2008",
       make_rotate_bvh, TechniqueKind::kHistory},
      {"decomp-refit", "Clusters, refitted", "motion clusters, their hierarchies refitted",
       "Lo09 §4.4", make_decomp_refit},
      {"auto", "Automatic", "whichever of ours measures cheapest here", "measured", make_auto,
       TechniqueKind::kAdaptive},
#ifdef MDK_HAVE_EMBREE
      {"embree", "Embree", "a peer, in the mode that measures best", "Embree 3", make_embree,
       TechniqueKind::kPeer},
      {"embree-refit", "Embree, refitted", "a peer: its hierarchy refitted every frame", "Embree 3",
       make_embree_refit, TechniqueKind::kPeer},
      {"embree-low", "Embree, rebuilt fast", "a peer: built anew every frame, low quality",
       "Embree 3", make_embree_low, TechniqueKind::kPeer},
      {"embree-medium", "Embree, rebuilt", "a peer: built anew every frame, medium quality",
       "Embree 3", make_embree_medium, TechniqueKind::kPeer},
#endif
      {"brute-force", "Brute force", "every triangle for every tile: the oracle", "–",
       make_brute_force, TechniqueKind::kOracle},
  };
  return kTable;
}

const TechniqueInfo& find_technique(std::string_view id) {
  std::string known;
  for (const TechniqueInfo& row : technique_table()) {
    if (row.id == id) return row;
    known.append(known.empty() ? "" : ", ").append(row.id);
  }
  throw Error(ErrorCode::kUsage,
              "no technique is called '" + std::string(id) + "'; there are " + known);
}

}  // namespace mdk
