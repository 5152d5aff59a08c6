// Along a chain of bones each joint takes over at the plane that halves the angle there, with a
// soft passage about as long as the finger is thick. Which chain a vertex belongs to follows from
// the distance fields of the digits; between two of them the palm takes the rest. Smoothing over
// the mesh (heat that flows along the skin, never through the air) then evens out the seams.
#include "assets/skin_weights.h"

#include <algorithm>
#include <numeric>

namespace mdk {
namespace {

constexpr int kSmoothingRounds = 8;

class Weighting {
 public:
  Weighting(const TriangleMesh& mesh, const HandSkeleton& skeleton, const HandShape& shape)
      : mesh_(mesh), skeleton_(skeleton), shape_(shape), joints_(skeleton.joints.size()) {}

  std::vector<SkinInfluence> run() {
    for (const Vec3d& p : mesh_.positions) {
      rows_.push_back(first_guess(p));
      owners_.push_back(owner(p));
    }
    smooth();
    std::vector<SkinInfluence> result;
    for (std::size_t v = 0; v < rows_.size(); ++v) {
      confine(v);
      result.push_back(strongest_four(rows_[v]));
    }
    return result;
  }

 private:
  using Row = std::vector<double>;  ///< a weight per joint

  std::size_t digit_joint(std::size_t digit, std::size_t i) const {
    return static_cast<std::size_t>(skeleton_.digits[digit][i]);
  }

  /// 0 before joint `joint`, 1 beyond it, along the mean of its bone and its parent's.
  double beyond(int joint, const Vec3d& p, double width) const {
    const RigJoint& j = skeleton_.joints[static_cast<std::size_t>(joint)];
    const Vec3d axis = normalized(j.rest.y + skeleton_.rest(j.parent).y);
    return smooth_step(-width, width, dot(p - j.rest.origin, axis));
  }

  Row first_guess(const Vec3d& p) const {
    Row row(joints_);
    const std::array<double, kDigits> shares = digit_shares(p);
    double rest = 1;
    for (std::size_t d = 0; d < kDigits; ++d) {
      rest -= shares[d];
      add_chain(d, p, shares[d], row);
    }
    add_palm(p, rest, row);
    return row;
  }

  /// How much of the vertex is each digit's; what is missing to 1 is the palm's.
  std::array<double, kDigits> digit_shares(const Vec3d& p) const {
    constexpr double kReach = 0.55;
    std::array<double, kDigits> shares{};
    double total = 0;
    for (std::size_t d = 0; d < kDigits; ++d) {
      const double away = std::max(shape_.digits()[d].distance(p), 0.0);
      const double s = std::max(1 - away / kReach, 0.0);
      shares[d] = s * s;
      total += shares[d];
    }
    if (total > 1)
      for (double& s : shares) s /= total;
    return shares;
  }

  /// Spreads `share` over the joints of a digit and what it stands on.
  void add_chain(std::size_t digit, const Vec3d& p, double share, Row& row) const {
    if (share == 0) return;
    const DigitShape& shape = shape_.digits()[digit];
    const auto& chain = skeleton_.digits[digit];
    const double first = digit == 0 ? thumb_share(p) : beyond(chain[0], p, 0.95 * shape.radius(0));
    const double second = beyond(chain[1], p, 0.72 * shape.radius(1));
    const double third = beyond(chain[2], p, 0.70 * shape.radius(2));
    add_palm(p, share * (1 - first), row);
    row[digit_joint(digit, 0)] += share * first * (1 - second);
    row[digit_joint(digit, 1)] += share * first * second * (1 - third);
    row[digit_joint(digit, 2)] += share * first * second * third;
  }

  /// The thumb's first bone lies within the palm: its hold fades with the distance from it.
  double thumb_share(const Vec3d& p) const {
    const Basis& bone = skeleton_.rest(skeleton_.digits[0][0]);
    const double len = skeleton_.bone_length(skeleton_.digits[0][0]);
    const Vec3d q = bone.to_local(p);
    const double s = std::clamp(q.y, 0.0, 3 * len);
    const double away = length(q - Vec3d{0, s, 0});
    return smooth_step(2.6, 0.9, away - 0.15 * s) * smooth_step(-0.8, 2.4, q.y);
  }

  /// Palm, thumb root and arm.
  void add_palm(const Vec3d& p, double share, Row& row) const {
    const double hand = smooth_step(-1.3, 1.1, p.y);
    const double twist = std::clamp((p.y + 4.6) / 3.4, 0.0, 1.0);
    const double thumb = thumb_share(p) * hand;
    const double side = smooth_step(1.2, 5.5, p.y) * (1 - thumb);
    const double little = side * smooth_step(-1.2, -2.9, p.x);
    const double ring = side * smooth_step(0.3, -1.4, p.x) * (1 - smooth_step(-1.2, -2.9, p.x));
    const auto add = [&](int joint, double w) {
      row[static_cast<std::size_t>(joint)] += share * w;
    };
    add(skeleton_.digits[0][0], thumb);
    add(skeleton_.little_metacarpal, hand * little);
    add(skeleton_.ring_metacarpal, hand * ring);
    add(skeleton_.hand, hand * (1 - little - ring) - thumb);
    add(skeleton_.forearm_twist, (1 - hand) * twist);
    add(skeleton_.forearm, (1 - hand) * (1 - twist));
  }

  /// The digit whose joints alone (and the palm's) may move `p`, or -1 in the palm and its webs; -2
  /// for cloth, which only the forearm moves.
  int owner(const Vec3d& p) const {
    const HandPart part = shape_.part(p);
    if (part == HandPart::kBand || part == HandPart::kSleeve) return -2;
    for (std::size_t d = 0; d < kDigits; ++d) {
      const DigitShape& digit = shape_.digits()[d];
      const double along = digit.basis(0).to_local(p).y / digit.bone_length(0);
      if (along > 0.55 && digit.distance(p) < 0.12) return static_cast<int>(d);
    }
    return -1;
  }

  void smooth() {
    std::vector<std::vector<std::uint32_t>> ring(rows_.size());
    for (const auto& t : mesh_.triangles)
      for (std::size_t i = 0; i < 3; ++i) ring[t[i]].push_back(t[(i + 1) % 3]);
    for (int round = 0; round < kSmoothingRounds; ++round) {
      std::vector<Row> next = rows_;
      for (std::size_t v = 0; v < rows_.size(); ++v)
        for (std::size_t j = 0; j < joints_; ++j) {
          double sum = 0;
          for (const std::uint32_t n : ring[v]) sum += rows_[n][j];
          next[v][j] = 0.5 * rows_[v][j] + 0.5 * sum / static_cast<double>(ring[v].size());
        }
      rows_ = std::move(next);
    }
  }

  /// Takes away what its owner does not allow.
  void confine(std::size_t v) {
    if (owners_[v] == -1) return;
    for (std::size_t d = 0; d < kDigits; ++d)
      if (owners_[v] != static_cast<int>(d))
        for (std::size_t i = 0; i < kPhalanges; ++i) rows_[v][digit_joint(d, i)] = 0;
    if (owners_[v] == -2) {
      rows_[v].assign(joints_, 0);
      rows_[v][static_cast<std::size_t>(skeleton_.forearm)] = 1;
    }
  }

  SkinInfluence strongest_four(const Row& row) const {
    std::vector<std::size_t> order(joints_);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return row[a] > row[b]; });
    double total = 0;
    for (std::size_t i = 0; i < 4; ++i) total += row[order[i]];
    SkinInfluence result;
    int left = 65535;
    for (std::size_t i = 4; i-- > 1;) {
      const auto w = static_cast<int>(row[order[i]] / total * 65535.0);
      // A trace of a weight costs a joint's look-up and moves nothing.
      if (w < 200) continue;
      result.joints[i] = static_cast<std::uint8_t>(order[i]);
      result.weights[i] = static_cast<std::uint16_t>(w);
      left -= w;
    }
    result.joints[0] = static_cast<std::uint8_t>(order[0]);
    result.weights[0] = static_cast<std::uint16_t>(left);
    return result;
  }

  const TriangleMesh& mesh_;
  const HandSkeleton& skeleton_;
  const HandShape& shape_;
  std::size_t joints_;
  std::vector<Row> rows_;
  std::vector<int> owners_;
};

}  // namespace

std::vector<SkinInfluence> skin_weights(const TriangleMesh& mesh, const HandSkeleton& skeleton,
                                        const HandShape& shape) {
  return Weighting(mesh, skeleton, shape).run();
}

}  // namespace mdk
