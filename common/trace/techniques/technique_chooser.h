// TechniqueChooser: traces with whichever of several techniques costs least on this model, view and
// machine, as measured.
//
//     most frames    the incumbent serves, and one tile in sixteen is timed
//     a trial        a challenger serves two frames instead; the first brings its structure back
//                    into the caches, the cost of the second counts relative to the incumbent's in
//                    the frames around it, since motion changes both alike
//
// In a new view each challenger is tried, twice unless hopeless; later one at a time, seldom, since
// motion may wear a refitted hierarchy out. No trial begins that would bring what trials have cost
// above a few per cent of all frames.
#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/trace/technique.h"

namespace mdk {

struct TechniqueCandidate {
  std::string_view id;
  std::unique_ptr<Technique> (*make)(const ModelView&);
};

class TechniqueChooser final : public Technique {
 public:
  /// `candidates`: at least one; the first serves until another has proved better. The list must
  /// live as long as this does.
  TechniqueChooser(const ModelView& model, std::span<const TechniqueCandidate> candidates);

  void prebuild(const PosedMesh& mesh) override;
  void update(const PosedMesh& mesh) override;
  void set_view(const PinholeRays& rays) override;
  bool trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const override;
  void prepare_occlusion() override;
  void occlude(RayBeam& beam, TileScratch& scratch) const override;
  std::size_t structure_bytes() const override;

  /// "refit-bvh, 5.2 ms; rebuild-bvh +63 %": the choice and how far behind the others were.
  std::string note() const override;

 private:
  /// What is known of a candidate in one view.
  struct Standing {
    int trials = 0;
    double relative_cost = 1;  ///< of a frame, update and trace; the view's unit is unit_ms
  };
  /// A view in which the candidates were compared.
  struct View {
    PinholeRays rays{};
    std::vector<Standing> standings;  ///< one per candidate
    std::size_t incumbent = 0;
    double unit_ms = 0;  ///< what a relative cost of 1 is now
    std::size_t frames = 0;
    std::size_t next_check = 0;  ///< frame from which a settled choice is questioned
    std::size_t last_challenger = 0;
    double spent_ms = 0;  ///< on trials, beyond what the incumbent would have cost

    double cost_ms(std::size_t i) const { return standings[i].relative_cost * unit_ms; }
  };

  Technique& candidate(std::size_t i);
  bool is_near(const PinholeRays& a, const PinholeRays& b) const;
  View& enter_view(const PinholeRays& rays);
  double measured_frame_ms();
  void learn(View& view, double frame_ms) const;
  std::size_t next_to_serve(View& view);
  bool can_afford(const View& view, std::size_t challenger) const;

  const ModelView& model_;
  std::span<const TechniqueCandidate> candidates_;
  std::vector<std::unique_ptr<Technique>> techniques_;  ///< made when first needed
  std::vector<View> views_;                             ///< the current one last
  std::size_t serving_ = 0;                             ///< the current frame
  bool is_first_frame_ = true;       ///< of the view: what it costs is not typical
  bool is_warming_up_ = false;       ///< the first frame of a trial
  const PosedMesh* mesh_ = nullptr;  ///< of the current frame
  double update_ms_ = 0;
  mutable std::vector<float> tile_ms_;          ///< of the timed tiles of the current frame
  mutable std::atomic<std::size_t> timed_ = 0;  ///< tiles
};

}  // namespace mdk
