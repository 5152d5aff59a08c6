// A square grid of particles under constraints along its sides, its diagonals and over two cells,
// which are met one after the other in a fixed order (XPBD, Macklin, Müller and Chentanez 2016, one
// iteration there and back per small step).
#include "assets/cloth_asset.h"

#include <algorithm>
#include <cmath>

#include "assets/wave.h"

namespace mdk {
namespace {

constexpr int kKeys = 100, kSteps = 30;
constexpr double kStepSeconds = 1.0 / 30 / kSteps;
constexpr std::uint32_t kCells = 67;  // to a side: 8,978 triangles
constexpr double kSide = 2.0;
constexpr ByteColor kRed{190, 44, 40}, kCream{240, 226, 196}, kDark{110, 20, 26};

struct Link {
  std::uint32_t a = 0, b = 0;
  double rest = 0, compliance = 0;
};

constexpr std::uint32_t kLeftCorner = 0, kRightCorner = kCells;

class Cloth {
 public:
  Cloth() {
    const double cell = kSide / kCells;
    for (std::uint32_t j = 0; j <= kCells; ++j)
      for (std::uint32_t i = 0; i <= kCells; ++i) {
        const double x = i * cell - kSide / 2, z = j * cell - kSide / 2;
        // Half lifted towards the viewer, and not quite flat.
        positions_.push_back(
            {x, -0.6 * (z + kSide / 2) + 0.02 * sine(x + 0.4 * z), 0.8 * (z + kSide / 2)});
      }
    velocities_.assign(positions_.size(), {});
    for (std::uint32_t j = 0; j <= kCells; ++j)
      for (std::uint32_t i = 0; i <= kCells; ++i) link_from(i, j, cell);
  }

  void step(double seconds) {
    const Vec3d wind{1.2 * sine(0.7 * seconds), 0.4, 2.2 * sine(0.53 * seconds + 0.3)};
    blow(wind);
    const std::vector<Vec3d> before = positions_;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      velocities_[i] += Vec3d{0, -7, 0} * kStepSeconds;
      positions_[i] += velocities_[i] * kStepSeconds;
    }
    positions_[kLeftCorner] = hand(-1, seconds + kStepSeconds);
    positions_[kRightCorner] = hand(1, seconds + kStepSeconds);
    // There and back, so that a pull travels both ways.
    for (const Link& link : links_) relax(link);
    for (std::size_t i = links_.size(); i-- > 0;) relax(links_[i]);
    for (std::size_t i = 0; i < positions_.size(); ++i)
      velocities_[i] = (positions_[i] - before[i]) * (1 / kStepSeconds);
  }

  const std::vector<Vec3d>& positions() const { return positions_; }
  static std::uint32_t number(std::uint32_t i, std::uint32_t j) { return j * (kCells + 1) + i; }

 private:
  void link_from(std::uint32_t i, std::uint32_t j, double cell) {
    constexpr double kWeave = 1e-8, kShear = 3e-6, kBending = 2e-4;
    const auto link = [&](int di, int dj, double compliance) {
      const std::int64_t x = std::int64_t{i} + di, y = std::int64_t{j} + dj;
      if (x < 0 || x > kCells || y > kCells) return;
      const double rest = cell * std::sqrt(static_cast<double>(di * di + dj * dj));
      links_.push_back({number(i, j),
                        number(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)), rest,
                        compliance});
    };
    link(1, 0, kWeave);
    link(0, 1, kWeave);
    link(1, 1, kShear);
    link(-1, 1, kShear);
    link(2, 0, kBending);
    link(0, 2, kBending);
  }

  /// Inverse mass: what is held does not give way.
  static double give(std::uint32_t v) { return v == kLeftCorner || v == kRightCorner ? 0 : 1; }

  void relax(const Link& link) {
    const Vec3d apart = positions_[link.b] - positions_[link.a];
    const double now = length(apart);
    if (now == 0) return;
    const double softness = link.compliance / (kStepSeconds * kStepSeconds);
    const double give_a = give(link.a), give_b = give(link.b);
    const Vec3d push = apart * ((now - link.rest) / ((give_a + give_b + softness) * now));
    positions_[link.a] += push * give_a;
    positions_[link.b] += push * -give_b;
  }

  /// Air takes each cell along, as far as it stands across the flow.
  void blow(const Vec3d& wind) {
    constexpr double kAir = 3.2;  // per second
    for (std::uint32_t j = 0; j < kCells; ++j)
      for (std::uint32_t i = 0; i < kCells; ++i) {
        const std::uint32_t corners[4] = {number(i, j), number(i + 1, j), number(i + 1, j + 1),
                                          number(i, j + 1)};
        const Vec3d across = positions_[corners[2]] - positions_[corners[0]];
        const Vec3d normal =
            normalized(cross(across, positions_[corners[3]] - positions_[corners[1]]));
        Vec3d flow = wind;
        for (const std::uint32_t v : corners) flow += velocities_[v] * -0.25;
        const Vec3d gain = normal * (dot(flow, normal) * kAir * kStepSeconds * 0.25);
        for (const std::uint32_t v : corners) velocities_[v] += gain;
      }
  }

  /// Where the hand on the side of `sign` holds its corner: up and down, ever harder, out of step.
  static Vec3d hand(double sign, double seconds) {
    const double shake = smooth_step(0.3, 0.8, seconds);
    const double lift = 0.34 * shake * sine(1.5 * seconds + 0.11 * sign);
    const double fetch = 0.16 * shake * sine(0.75 * seconds);
    return {sign * (kSide / 2 - 0.16 * shake), lift, fetch};
  }

  std::vector<Vec3d> positions_, velocities_;
  std::vector<Link> links_;
};

ByteColor color(std::uint32_t i, std::uint32_t j) {
  constexpr std::uint32_t kHem = 3, kCheck = 8;
  if (std::min({i, j, kCells - i, kCells - j}) < kHem) return kDark;
  return (i / kCheck + j / kCheck) % 2 ? kRed : kCream;
}

}  // namespace

SampleSequence make_cloth() {
  SampleSequence sequence;
  for (std::uint32_t j = 0; j <= kCells; ++j)
    for (std::uint32_t i = 0; i <= kCells; ++i) sequence.colors.push_back(color(i, j));
  for (std::uint32_t j = 0; j < kCells; ++j)
    for (std::uint32_t i = 0; i < kCells; ++i) {
      const std::uint32_t a = Cloth::number(i, j), b = a + 1, d = Cloth::number(i, j + 1);
      sequence.triangles.push_back({a, d, b});
      sequence.triangles.push_back({b, d, d + 1});
    }
  Cloth cloth;
  for (int key = 0; key < kKeys; ++key) {
    sequence.poses.push_back(cloth.positions());
    for (int i = 0; i < kSteps; ++i) cloth.step(key / 30.0 + i * kStepSeconds);
  }
  return sequence;
}

}  // namespace mdk
