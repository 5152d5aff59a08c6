#include "common/trace/techniques/technique_chooser.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "common/base/parallel.h"
#include "common/base/stopwatch.h"

namespace mdk {
namespace {

constexpr std::size_t kMaxTimedTiles = 16384;
constexpr std::size_t kTilesPerExpensive = 32;
constexpr float kInterrupted = 8;    ///< times what an expensive tile takes
constexpr double kMaxGrowth = 1.25;  ///< of a frame on the last one that is believed
constexpr int kTrialsToSettle = 2;
constexpr std::size_t kFramesBetweenChecks = 64;
constexpr double kHopeless = 1.4;  ///< times the best: not worth a second trial
constexpr double kWorthChanging = 0.98;
constexpr double kTrialShare = 0.03;     ///< of all frames' time
constexpr double kFramesInAdvance = 25;  ///< trials may spend the share of so many frames to come
constexpr double kTrialFrames = 2;
constexpr double kUnknownExcess = 0.3;  ///< expected of a first trial, in frames
constexpr std::size_t kMaxViews = 32;

/// Looking at a clock costs as much as tracing an empty tile, so one tile in so many is timed.
constexpr std::uint32_t kTilesPerTimed = 16;

/// The same tiles in every frame, spread over the picture.
bool is_timed(const TileRays& tile) {
  return (tile.x + 5 * tile.y) / kTileSide % kTilesPerTimed == 0;
}

/// Time apart from posing, which falls to whoever asks first and is alike for all.
class WorkClock {
 public:
  explicit WorkClock(const PosedMesh& mesh) : mesh_(mesh), posing_(mesh.posing_seconds()) {}
  double milliseconds() const {
    return std::max(0.0, watch_.seconds() - (mesh_.posing_seconds() - posing_)) * 1e3;
  }

 private:
  const PosedMesh& mesh_;
  double posing_;
  Stopwatch watch_;
};

template <class... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

}  // namespace

TechniqueChooser::TechniqueChooser(const ModelView& model,
                                   std::span<const TechniqueCandidate> candidates)
    : model_(model),
      candidates_(candidates),
      techniques_(candidates.size()),
      tile_ms_(kMaxTimedTiles) {}

void TechniqueChooser::prebuild(const PosedMesh& mesh) {
  if (!views_.empty()) {
    View& view = views_.back();
    const double frame_ms = measured_frame_ms();
    if (!is_first_frame_ && frame_ms > 0) learn(view, frame_ms);
    serving_ = next_to_serve(view);
  }
  candidate(serving_).prebuild(mesh);
}

void TechniqueChooser::update(const PosedMesh& mesh) {
  const WorkClock clock(mesh);
  candidate(serving_).update(mesh);
  update_ms_ = clock.milliseconds();
  mesh_ = &mesh;
}

void TechniqueChooser::set_view(const PinholeRays& rays) {
  is_first_frame_ = views_.empty() || !is_near(views_.back().rays, rays);
  if (is_first_frame_) enter_view(rays);
  ++views_.back().frames;
  candidate(serving_).set_view(rays);
  timed_ = 0;
}

bool TechniqueChooser::trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
                             TraceCounters* counters) const {
  const Technique& serving = *techniques_[serving_];
  if (!is_timed(tile)) return serving.trace(tile, hits, scratch, counters);
  const std::size_t number = timed_++;
  const WorkClock clock(*mesh_);
  const bool is_hit = serving.trace(tile, hits, scratch, counters);
  if (number < kMaxTimedTiles) tile_ms_[number] = static_cast<float>(clock.milliseconds());
  return is_hit;
}

void TechniqueChooser::prepare_occlusion() { candidate(serving_).prepare_occlusion(); }

void TechniqueChooser::occlude(RayBeam& beam, TileScratch& scratch) const {
  techniques_[serving_]->occlude(beam, scratch);
}

std::size_t TechniqueChooser::structure_bytes() const {
  std::size_t bytes = 0;
  for (const auto& technique : techniques_)
    if (technique != nullptr) bytes += technique->structure_bytes();
  return bytes;
}

std::string TechniqueChooser::note() const {
  if (views_.empty()) return {};
  const View& view = views_.back();
  std::string text(candidates_[view.incumbent].id);
  if (view.unit_ms > 0) text += formatted(", %.1f ms", view.cost_ms(view.incumbent));
  const double best = view.standings[view.incumbent].relative_cost;
  const char* separator = "; ";
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const Standing& standing = view.standings[i];
    if (i == view.incumbent || standing.trials == 0) continue;
    text.append(separator).append(candidates_[i].id);
    text += formatted(" %+.0f %%", (standing.relative_cost / best - 1) * 100);
    separator = ", ";
  }
  return text;
}

Technique& TechniqueChooser::candidate(std::size_t i) {
  if (techniques_[i] == nullptr) techniques_[i] = candidates_[i].make(model_);
  return *techniques_[i];
}

/// Whether a choice made for `a` can be expected to hold for `b`.
bool TechniqueChooser::is_near(const PinholeRays& a, const PinholeRays& b) const {
  const float distance =
      std::max(length(a.origin - model_.bounds.center()), 0.1f * diagonal(model_.bounds));
  if (length(b.origin - a.origin) > 0.2f * distance) return false;
  const float zoom = length(b.du) / length(a.du);
  if (!(zoom > 0.75f && zoom < 1.33f)) return false;
  return dot(normalized(cross(a.du, a.dv)), normalized(cross(b.du, b.dv))) > 0.95f;
}

/// The entry of this view, now the last one; a new one begins with the choice of the last view.
TechniqueChooser::View& TechniqueChooser::enter_view(const PinholeRays& rays) {
  const auto known = std::find_if(views_.begin(), views_.end(),
                                  [&](const View& view) { return is_near(view.rays, rays); });
  if (known != views_.end()) {
    std::rotate(known, known + 1, views_.end());
    return views_.back();
  }
  View view;
  view.rays = rays;
  view.standings.resize(candidates_.size());
  view.incumbent = view.last_challenger = serving_;
  view.next_check = kFramesBetweenChecks;
  if (views_.size() == kMaxViews) views_.erase(views_.begin());
  views_.push_back(std::move(view));
  return views_.back();
}

/// Update and trace of the last frame, from its timed tiles; 0 where there were none.
double TechniqueChooser::measured_frame_ms() {
  const std::size_t timed = std::min<std::size_t>(timed_, kMaxTimedTiles);
  if (timed == 0) return 0;
  // Tiles that take much longer than other expensive ones were interrupted.
  const auto end = tile_ms_.begin() + static_cast<std::ptrdiff_t>(timed);
  const auto expensive = tile_ms_.begin() + static_cast<std::ptrdiff_t>(timed / kTilesPerExpensive);
  std::nth_element(tile_ms_.begin(), expensive, end, std::greater<>());
  double sum = 0;
  for (auto tile = tile_ms_.begin(); tile != end; ++tile)
    sum += static_cast<double>(std::min(*tile, kInterrupted * *expensive));
  const double scale = static_cast<double>(timed_) / static_cast<double>(timed);
  return update_ms_ + sum * scale * kTilesPerTimed / thread_count();
}

void TechniqueChooser::learn(View& view, double frame_ms) const {
  Standing& served = view.standings[serving_];
  if (serving_ == view.incumbent || view.unit_ms == 0) {
    const double unit = frame_ms / served.relative_cost;
    view.unit_ms =
        view.unit_ms == 0 ? unit : (view.unit_ms + std::min(unit, kMaxGrowth * view.unit_ms)) / 2;
    return;
  }
  view.spent_ms += std::max(0.0, frame_ms - view.cost_ms(view.incumbent));
  if (is_warming_up_) return;
  const double relative = frame_ms / view.unit_ms;
  if (served.trials == 0) {
    served.relative_cost = relative;
  } else if (served.trials < kTrialsToSettle) {  // the same moment, nearly: noise only adds
    served.relative_cost = std::min(served.relative_cost, relative);
  } else {
    served.relative_cost = (served.relative_cost + relative) / 2;
  }
  ++served.trials;
  const Standing& incumbent = view.standings[view.incumbent];
  if (served.relative_cost < kWorthChanging * incumbent.relative_cost) {
    view.standings[view.incumbent].trials = std::max(1, incumbent.trials);
    view.incumbent = serving_;
  }
}

/// The incumbent, or a challenger: those whose trials are not complete, in turn; later, at long
/// intervals, each again. Between two trials the incumbent serves, to be measured beside them.
std::size_t TechniqueChooser::next_to_serve(View& view) {
  const bool was_trial = serving_ != view.incumbent;
  if (is_warming_up_) {
    is_warming_up_ = false;
    if (was_trial) return serving_;
  }
  if (was_trial || view.unit_ms == 0) return view.incumbent;
  const auto is_settled = [&](std::size_t i) {
    const Standing& standing = view.standings[i];
    return standing.trials >= kTrialsToSettle ||
           (standing.trials > 0 && view.cost_ms(i) > kHopeless * view.cost_ms(view.incumbent));
  };
  const bool check = view.frames >= view.next_check;
  for (std::size_t step = 1; step <= candidates_.size(); ++step) {
    const std::size_t i = (view.last_challenger + step) % candidates_.size();
    const bool settled = is_settled(i);
    if (i == view.incumbent || (settled && !check) || !can_afford(view, i)) continue;
    if (settled) view.next_check = view.frames + kFramesBetweenChecks;
    view.last_challenger = i;
    is_warming_up_ = true;
    return i;
  }
  return view.incumbent;
}

bool TechniqueChooser::can_afford(const View& view, std::size_t challenger) const {
  const double frame_ms = view.cost_ms(view.incumbent);
  const double excess = view.standings[challenger].trials > 0
                            ? kTrialFrames * std::max(0.0, view.cost_ms(challenger) - frame_ms)
                            : kUnknownExcess * frame_ms;
  const double frames = kFramesInAdvance + static_cast<double>(view.frames);
  return view.spent_ms + excess <= kTrialShare * frames * frame_ms;
}

}  // namespace mdk
