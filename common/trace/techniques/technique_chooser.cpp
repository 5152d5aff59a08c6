#include "common/trace/techniques/technique_chooser.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "common/base/parallel.h"
#include "common/base/stopwatch.h"

namespace mdk {
namespace {

constexpr std::size_t kNobody = ~std::size_t{0};
constexpr std::uint32_t kTilesPerSample = 16;
constexpr std::size_t kTilesPerOutlier = 32;
constexpr std::size_t kMostSamples = 4096;
constexpr int kTrialsToSettle = 2;
constexpr std::size_t kFramesBetweenChecks = 64;
constexpr double kHopeless = 1.6;  ///< times the best: not worth a second trial
constexpr double kWorthChanging = 0.97;
constexpr double kTrialShare = 0.035;    ///< of all frames' time
constexpr double kFramesInAdvance = 25;  ///< trials may spend the share of so many frames to come
constexpr std::size_t kMostViews = 32;

/// "+63 %" for 1.63.
std::string percent_behind(double ratio) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%+.0f %%", (ratio - 1) * 100);
  return text.data();
}

std::string milliseconds(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f ms", value);
  return text.data();
}

}  // namespace

TechniqueChooser::TechniqueChooser(const Model& model,
                                   std::span<const TechniqueCandidate> candidates)
    : model_(model),
      candidates_(candidates),
      techniques_(candidates.size()),
      challenger_(kNobody) {}

void TechniqueChooser::prebuild(const PosedMesh& mesh) {
  judge_trial();
  challenger_ = kNobody;
  if (!views_.empty()) {
    View& view = views_.back();
    serving_ = view.incumbent;
    challenger_ = pick_challenger(view);
    if (challenger_ != kNobody) samples_.resize(kMostSamples);
  }
  candidate(serving_).prebuild(mesh);
  if (challenger_ != kNobody) candidate(challenger_).prebuild(mesh);
}

void TechniqueChooser::update(const PosedMesh& mesh) {
  Stopwatch watch;
  candidate(serving_).update(mesh);
  serving_update_ms_ = watch.lap() * 1e3;
  if (challenger_ != kNobody) candidate(challenger_).update(mesh);
  challenger_update_ms_ = watch.lap() * 1e3;
}

void TechniqueChooser::set_view(const PinholeRays& rays) {
  ++enter_view(rays).frames;
  candidate(serving_).set_view(rays);
  if (challenger_ != kNobody) candidate(challenger_).set_view(rays);
}

void TechniqueChooser::trace(const TileRays& tile, TileHits& hits, TileScratch& scratch,
                             TraceCounters* counters) const {
  const Technique& serving = made(serving_);
  if (challenger_ == kNobody) return serving.trace(tile, hits, scratch, counters);
  ++tiles_;
  const std::size_t sample = is_sampled(tile) ? sampled_++ : kNobody;
  if (sample >= samples_.size()) return serving.trace(tile, hits, scratch, counters);

  TileHits discarded;
  discarded.clear();
  const auto serve = [&] {
    const Stopwatch watch;
    serving.trace(tile, hits, scratch, counters);
    samples_[sample].serving_ms = static_cast<float>(watch.milliseconds());
  };
  const auto challenge = [&] {
    const Stopwatch watch;
    made(challenger_).trace(tile, discarded, scratch, nullptr);
    samples_[sample].challenger_ms = static_cast<float>(watch.milliseconds());
  };
  // Whoever comes second finds the vertices in the cache: they take turns.
  if (sample % 2 == 0) {
    serve();
    challenge();
  } else {
    challenge();
    serve();
  }
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
  const double best = view.cost_ms(view.incumbent);
  if (view.first_trace_ms > 0) text.append(", ").append(milliseconds(best));
  const char* separator = "; ";
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (i == view.incumbent || view.standings[i].trials == 0) continue;
    text.append(separator).append(candidates_[i].id).append(" ");
    text += percent_behind(view.cost_ms(i) / best);
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
      std::max(length(a.origin - model_.bounds.center()), 0.1f * model_.bounds.diagonal());
  if (length(b.origin - a.origin) > 0.2f * distance) return false;
  const float zoom = length(b.du) / length(a.du);
  if (!(zoom > 0.75f && zoom < 1.33f)) return false;
  return dot(normalized(cross(a.du, a.dv)), normalized(cross(b.du, b.dv))) > 0.95f;
}

/// The entry of this view, now the last one; a new one begins with the choice of the last view.
TechniqueChooser::View& TechniqueChooser::enter_view(const PinholeRays& rays) {
  const auto known = std::find_if(views_.rbegin(), views_.rend(),
                                  [&](const View& view) { return is_near(view.rays, rays); });
  if (known != views_.rend()) {
    std::rotate(known.base() - 1, known.base(), views_.end());
    return views_.back();
  }
  View view;
  view.rays = rays;
  view.standings.resize(candidates_.size());
  view.incumbent = view.last_challenger = serving_;
  if (views_.size() == kMostViews) views_.erase(views_.begin());
  views_.push_back(std::move(view));
  return views_.back();
}

void TechniqueChooser::judge_trial() {
  const std::size_t sampled = std::min<std::size_t>(sampled_, samples_.size());
  if (challenger_ != kNobody && sampled > 0) {
    // Tiles that take extremely long were interrupted: left out for both alike.
    const auto longest_first = [](const Sample& a, const Sample& b) {
      return std::max(a.serving_ms, a.challenger_ms) > std::max(b.serving_ms, b.challenger_ms);
    };
    const auto end = samples_.begin() + static_cast<std::ptrdiff_t>(sampled);
    const auto kept = samples_.begin() + static_cast<std::ptrdiff_t>(sampled / kTilesPerOutlier);
    std::nth_element(samples_.begin(), kept, end, longest_first);
    double serving_ms = 0, challenger_ms = 0;
    for (auto sample = kept; sample != end; ++sample) {
      serving_ms += static_cast<double>(sample->serving_ms);
      challenger_ms += static_cast<double>(sample->challenger_ms);
    }
    const double tiles_per_kept = static_cast<double>(tiles_) / static_cast<double>(end - kept);
    record_trial(serving_ms, challenger_ms, tiles_per_kept / thread_count());
  }
  tiles_ = sampled_ = 0;
}

/// `frame_per_sum`: times the sums over the sampled tiles give the whole frame's time.
void TechniqueChooser::record_trial(double serving_ms, double challenger_ms, double frame_per_sum) {
  View& view = views_.back();
  Standing& serving = view.standings[serving_];
  Standing& challenger = view.standings[challenger_];
  const auto shortest = [](const Standing& standing, double ms, bool known) {
    return known ? std::min(standing.update_ms, ms) : ms;
  };
  serving.update_ms = shortest(serving, serving_update_ms_, view.first_trace_ms > 0);
  challenger.update_ms = shortest(challenger, challenger_update_ms_, challenger.trials > 0);
  const double relative = challenger_ms / serving_ms * serving.relative_trace;
  challenger.relative_trace =
      challenger.trials == 0 ? relative : (challenger.relative_trace + relative) / 2;
  ++challenger.trials;
  view.first_trace_ms = serving_ms * frame_per_sum / serving.relative_trace;
  challenger.trial_ms = challenger_update_ms_ + challenger_ms / thread_count();
  view.spent_ms += challenger.trial_ms;
  choose(view);
}

void TechniqueChooser::choose(View& view) const {
  std::size_t best = view.incumbent;
  for (std::size_t i = 0; i < candidates_.size(); ++i)
    if (view.standings[i].trials > 0 && view.cost_ms(i) < view.cost_ms(best)) best = i;
  if (view.cost_ms(best) < kWorthChanging * view.cost_ms(view.incumbent)) view.incumbent = best;
}

/// Who is tried in the next frame: those whose trials are not complete, in turn; later, at long
/// intervals, each again.
std::size_t TechniqueChooser::pick_challenger(View& view) const {
  const double best = view.cost_ms(view.incumbent);
  const auto is_settled = [&](std::size_t i) {
    const Standing& standing = view.standings[i];
    return i == view.incumbent || standing.trials >= kTrialsToSettle ||
           (standing.trials > 0 && view.cost_ms(i) > kHopeless * best);
  };
  const bool check = view.frames >= view.next_check;
  for (std::size_t step = 1; step <= candidates_.size(); ++step) {
    const std::size_t i = (view.last_challenger + step) % candidates_.size();
    const bool is_due = !is_settled(i) || (check && i != view.incumbent);
    if (!is_due || !can_afford(view, i)) continue;
    if (is_settled(i)) view.next_check = view.frames + kFramesBetweenChecks;
    view.last_challenger = i;
    return i;
  }
  return kNobody;
}

bool TechniqueChooser::can_afford(const View& view, std::size_t challenger) const {
  const double frame_ms = view.cost_ms(view.incumbent);
  if (view.first_trace_ms == 0) return true;  // the first trial tells what a frame costs
  const Standing& standing = view.standings[challenger];
  const double expected = standing.trials > 0 ? standing.trial_ms : 0.1 * frame_ms;
  const double frames = kFramesInAdvance + static_cast<double>(view.frames);
  return view.spent_ms + expected <= kTrialShare * frames * frame_ms;
}

bool TechniqueChooser::is_sampled(const TileRays& tile) const {
  const std::size_t column = tile.x / kTileSide, row = tile.y / kTileSide;
  return (column + 5 * row + 7 * views_.back().frames) % kTilesPerSample == 0;
}

}  // namespace mdk
