// Costs: what frames of the open file have cost, by technique, lately and along the clip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/trace/camera.h"
#include "common/trace/frame_stats.h"
#include "common/trace/heat_map.h"
#include "viewer/state/pose.h"

namespace mdk {

struct FrameSample {
  std::size_t technique = 0;  ///< row of technique_table()
  double time_to_image_ms = 0;
};

/// How long the latest frames took, by which technique; oldest first, bounded.
class FrameHistory {
 public:
  static constexpr std::size_t kCapacity = 160;
  static constexpr std::size_t kMedianOver = 15;

  void add(const FrameSample& sample);

  const std::deque<FrameSample>& samples() const { return samples_; }
  double longest_ms() const;

  /// Median over the technique's latest frames here (at most kMedianOver); empty where it has none.
  std::optional<double> median_ms(std::size_t technique) const;

 private:
  std::deque<FrameSample> samples_;
};

/// The last picture shown and what it cost.
struct FrameReport {
  std::size_t technique = 0;
  std::uint32_t width = 0, height = 0;
  FrameStats stats;  ///< without counters
  std::size_t structure_bytes = 0;
  std::string note;  ///< what the technique chose, where it chooses
  HeatScale heat;    ///< of heat maps
  Camera camera;
  Moment moment;
};

/// What the last counting frame counted.
struct WorkReport {
  std::size_t technique = 0;
  std::uint64_t rays = 0;
  TraceCounters counters;
};

/// Where two pictures of one view are not the same.
struct PictureDifference {
  std::uint64_t pixels = 0;   ///< how many
  std::uint32_t largest = 0;  ///< of one colour channel, 0 to 255
};

/// What a technique's latest frames cost.
struct TechniqueCost {
  FrameReport frame;
  std::optional<WorkReport> work;  ///< where it was counted
};

/// What the frames of the open file said.
struct FrameCosts {
  std::optional<FrameReport> last;
  std::optional<FrameReport> second;            ///< of the technique that is compared with the last
  std::optional<PictureDifference> difference;  ///< between the two
  std::optional<WorkReport> last_work;
  std::map<std::size_t, TechniqueCost> by_technique;  ///< by row of technique_table()
  FrameHistory history;

  void add(FrameReport frame);
  /// Of the technique that is compared with the one of the last add().
  void add_second(FrameReport frame, const PictureDifference& found);
  void add_work(const WorkReport& work);
};

/// What a picture costs along a clip, by each technique that was measured. Moments are measured
/// from coarse to fine, so that the shape of a curve is there early.
class CostCurves {
 public:
  static constexpr std::size_t kMaxMoments = 256;
  static constexpr int kPasses = 2;  ///< each moment is measured so often; the shorter time counts

  /// Forgets all and starts again for a clip with keys at `key_times`: all of them, or kMaxMoments
  /// spread evenly.
  void start(const std::vector<double>& key_times);

  /// Seconds from the clip's start, rising.
  const std::vector<double>& moments() const { return moments_; }
  /// One entry per moment, empty where it was not measured yet; none at all for a technique without
  /// a curve.
  std::span<const std::optional<double>> curve(std::size_t technique) const;
  std::size_t technique_count() const { return curves_.size(); }

  /// The moment to measure next; nothing when all are known.
  std::optional<std::size_t> next_moment(std::size_t technique) const;
  void add(std::size_t technique, std::size_t moment, double ms);

  std::size_t known(std::size_t technique) const;
  double longest_ms(std::size_t technique) const;

 private:
  struct Curve {
    std::vector<std::optional<double>> ms;
    std::size_t measured = 0;  ///< how often anything was added
  };

  std::vector<double> moments_;
  std::vector<std::size_t> order_;  ///< of measuring
  std::vector<Curve> curves_;       ///< by technique
};

}  // namespace mdk
