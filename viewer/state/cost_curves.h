// CostCurves: what a picture costs along a clip, by each technique that was measured. Moments are
// measured from coarse to fine, so that the shape of a curve is there early.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace mdk {

class CostCurves {
 public:
  static constexpr std::size_t kMostMoments = 256;
  static constexpr int kPasses = 2;  ///< each moment is measured so often; the least time counts

  /// Forgets all and begins anew for a clip with keys at `key_times`: all of them, or kMostMoments
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
