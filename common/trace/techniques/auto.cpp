// Whichever of ours measures cheapest on this model, view and machine.
#include "common/trace/techniques/makers.h"
#include "common/trace/techniques/technique_chooser.h"

namespace mdk {

std::unique_ptr<Technique> make_auto(const Model& model) {
  // Most likely best first; those that build anew in every frame are left out: where that could
  // pay, hybrid-bvh does it when it does.
  static constexpr TechniqueCandidate kCandidates[] = {{"fuzzy-bvh", make_fuzzy_bvh},
                                                       {"refit-bvh", make_refit_bvh},
                                                       {"tsah-refit", make_tsah_refit},
                                                       {"hybrid-bvh", make_hybrid_bvh}};
  return std::make_unique<TechniqueChooser>(model, kCandidates);
}

}  // namespace mdk
