// TechniqueChooser: traces with whichever of several techniques costs least on this model, view and
// machine, as measured.
//
//     frame    the incumbent serves all tiles; now and then a challenger is made valid too, and
//              traces one tile in sixteen a second time, clock in hand
//     verdict  both are compared on the same tiles of the same frame, update included; whichever
//              has the smaller estimate serves from the next frame on
//
// After a view change every challenger is tried, twice unless hopeless; later one at a time,
// seldom, since motion may wear a refitted hierarchy out. Trials stop where they would cost more
// than a few per cent of all frames.
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
  std::unique_ptr<Technique> (*make)(const Model&);
};

class TechniqueChooser final : public Technique {
 public:
  /// `candidates`: at least one; the first serves until another has proved better. The list must
  /// live as long as this does.
  TechniqueChooser(const Model& model, std::span<const TechniqueCandidate> candidates);

  void prebuild(const PosedMesh& mesh) override;
  void update(const PosedMesh& mesh) override;
  void set_view(const PinholeRays& rays) override;
  void trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
             TraceCounters* counters) const override;
  std::size_t structure_bytes() const override;

  /// "refit-bvh, 5.2 ms; rebuild-bvh +63 %": the choice and how far behind the others were.
  std::string note() const override;

 private:
  /// What is known of a candidate in one view.
  struct Standing {
    int trials = 0;
    double update_ms = 0;       ///< the shortest seen
    double relative_trace = 1;  ///< to the first candidate's: the mean of the trials
    double trial_ms = 0;        ///< what the last trial took on top of the frame
  };
  /// A view in which the candidates were compared.
  struct View {
    PinholeRays rays{};
    std::vector<Standing> standings;  ///< one per candidate
    std::size_t incumbent = 0;
    std::size_t frames = 0;      ///< seen in this view
    std::size_t next_check = 0;  ///< frame from which a settled choice is questioned
    std::size_t last_challenger = 0;
    double first_trace_ms = 0;  ///< what tracing costs the first candidate, as last estimated
    double spent_ms = 0;        ///< on trials

    /// Update and trace of candidate `i`, as far as is known.
    double cost_ms(std::size_t i) const {
      return standings[i].update_ms + standings[i].relative_trace * first_trace_ms;
    }
  };
  /// A tile that both traced.
  struct Sample {
    float serving_ms = 0, challenger_ms = 0;
  };

  Technique& candidate(std::size_t i);
  const Technique& made(std::size_t i) const { return *techniques_[i]; }
  bool is_near(const PinholeRays& a, const PinholeRays& b) const;
  View& enter_view(const PinholeRays& rays);
  void judge_trial();
  void record_trial(double serving_ms, double challenger_ms, double frame_per_sum);
  void choose(View& view) const;
  std::size_t pick_challenger(View& view) const;
  bool can_afford(const View& view, std::size_t challenger) const;
  bool is_sampled(const TileRays& tile) const;

  const Model& model_;
  std::span<const TechniqueCandidate> candidates_;
  std::vector<std::unique_ptr<Technique>> techniques_;  ///< made when first needed
  std::vector<View> views_;                             ///< the present one last
  std::size_t serving_ = 0;                             ///< the present frame
  std::size_t challenger_;                              ///< tried in the present frame, if any
  double serving_update_ms_ = 0, challenger_update_ms_ = 0;
  mutable std::vector<Sample> samples_;
  mutable std::atomic<std::size_t> tiles_ = 0, sampled_ = 0;
};

}  // namespace mdk
