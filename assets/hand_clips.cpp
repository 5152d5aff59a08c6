// A clip is a script of moves: at a time, over a duration, a joint eases to new angles. Within a
// finger the joints set off one after another, which is what makes the motion look alive.
#include "assets/hand_clips.h"

#include <array>
#include <cmath>

namespace mdk {
namespace {

constexpr double kKeysPerSecond = 30;

/// A digit's three joints, from the palm.
using DigitPose = std::array<JointAngles, kPhalanges>;
using HandPose = std::array<DigitPose, kDigits>;

constexpr HandPose kOpen = {{
    {{{-4, 0, 2}, {-4, 0, 0}, {-6, 0, 0}}},
    {{{-3, 0, 0}, {-1, 0, 0}, {-2, 0, 0}}},
    {{{-3, 0, 0}, {-1, 0, 0}, {-2, 0, 0}}},
    {{{-3, 0, 0}, {-1, 0, 0}, {-2, 0, 0}}},
    {{{-5, 0, 0}, {-2, 0, 0}, {-2, 0, 0}}},
}};

// Bending fingers come together: the spread of the rest pose is taken back.
constexpr HandPose kFist = {{
    {{{25, -34, -10}, {38, -12, -12}, {49, 0, 0}}},
    {{{84, 0, 7}, {106, 0, 0}, {68, 0, 0}}},
    {{{86, 0, 1}, {107, 0, 0}, {70, 0, 0}}},
    {{{85, 0, -5}, {106, 0, 0}, {70, 0, 0}}},
    {{{82, 0, -12}, {103, 0, 0}, {66, 0, 0}}},
}};

// The thumb laid into the palm, where no finger is in its way.
constexpr DigitPose kThumbFolded = {{{10, -38, 6}, {54, -12, -10}, {58, 0, 0}}};

double ease(double s) {
  s = std::min(std::max(s, 0.0), 1.0);
  return s * s * s * (s * (6 * s - 15) + 10);
}

class Script {
 public:
  Script(const HandSkeleton& skeleton, const HandPose& start)
      : skeleton_(skeleton), start_(skeleton.joints.size()), moves_(skeleton.joints.size()) {
    for (std::size_t d = 0; d < kDigits; ++d)
      for (std::size_t i = 0; i < kPhalanges; ++i)
        start_[static_cast<std::size_t>(skeleton.digits[d][i])] = start[d][i];
  }

  /// Moves of one joint must be given in order and must not overlap.
  void turn(int joint, double at, double seconds, const JointAngles& to) {
    moves_[static_cast<std::size_t>(joint)].push_back({at, seconds, to});
  }

  void move_digit(std::size_t digit, double at, double seconds, const DigitPose& to) {
    for (std::size_t i = 0; i < kPhalanges; ++i)
      turn(skeleton_.digits[digit][i], at + 0.05 * seconds * static_cast<double>(i), 0.9 * seconds,
           to[i]);
  }

  RigClip play(const std::string& name, double seconds) const {
    RigClip clip{name, {}, {}, {}};
    const int keys = static_cast<int>(std::lround(seconds * kKeysPerSecond)) + 1;
    for (int k = 0; k < keys; ++k) {
      const double t = k / kKeysPerSecond;
      clip.times.push_back(t);
      auto& pose = clip.poses.emplace_back();
      for (std::size_t j = 0; j < start_.size(); ++j) pose.push_back(angles_at(j, t));
    }
    return clip;
  }

 private:
  struct Move {
    double at, seconds;
    JointAngles to;
  };

  JointAngles angles_at(std::size_t joint, double t) const {
    JointAngles angles = start_[joint];
    for (const Move& move : moves_[joint])
      angles += (move.to - angles) * ease((t - move.at) / move.seconds);
    return angles;
  }

  const HandSkeleton& skeleton_;
  std::vector<JointAngles> start_;
  std::vector<std::vector<Move>> moves_;
};

RigClip grasp(const HandSkeleton& skeleton) {
  Script script(skeleton, kOpen);
  constexpr std::size_t kThumb = 0;
  for (std::size_t d = 1; d < kDigits; ++d) {
    const double wave = 0.07 * static_cast<double>(kDigits - 1 - d);
    script.move_digit(d, 0.08 + wave, 0.55, kFist[d]);
    script.move_digit(d, 1.22 + 0.07 * static_cast<double>(d - 1), 0.50, kOpen[d]);
  }
  script.move_digit(kThumb, 0.34, 0.55, kFist[kThumb]);
  script.move_digit(kThumb, 1.10, 0.50, kOpen[kThumb]);
  script.turn(skeleton.little_metacarpal, 0.1, 0.6, {9, 0, 0});
  script.turn(skeleton.little_metacarpal, 1.2, 0.6, {});
  script.turn(skeleton.ring_metacarpal, 0.1, 0.6, {5, 0, 0});
  script.turn(skeleton.ring_metacarpal, 1.2, 0.6, {});
  script.turn(skeleton.hand, 0.05, 0.85, {-14, 0, 4});
  script.turn(skeleton.hand, 1.1, 0.85, {});
  script.turn(skeleton.forearm_twist, 0.05, 0.9, {0, 24, 0});
  script.turn(skeleton.forearm_twist, 1.05, 0.9, {});
  return script.play("grasp", 2);
}

RigClip count(const HandSkeleton& skeleton) {
  Script script(skeleton, kFist);
  constexpr std::size_t kThumb = 0, kLittle = 4;
  constexpr double kBeat = 0.62, kFirst = 0.2, kClose = 3.35;
  for (std::size_t d = 1; d < kDigits; ++d) {
    const double at = kFirst + kBeat * static_cast<double>(d - 1);
    script.move_digit(d, at, 0.36, kOpen[d]);
    script.turn(skeleton.hand, at, 0.2, {5, 0, d % 2 ? -2.5 : 2.5});
    script.turn(skeleton.hand, at + 0.2, 0.25, {-3, 0, d % 2 ? -2.5 : 2.5});
    script.move_digit(d, kClose + 0.04 * static_cast<double>(kLittle - d), 0.45, kFist[d]);
  }
  const double four = kFirst + 3 * kBeat, five = four + kBeat;
  script.move_digit(kThumb, four - 0.3, 0.5, kThumbFolded);
  script.move_digit(kThumb, five, 0.4, kOpen[kThumb]);
  script.move_digit(kThumb, kClose + 0.12, 0.5, kFist[kThumb]);
  script.turn(skeleton.hand, five, 0.2, {5, 0, 0});
  script.turn(skeleton.hand, five + 0.2, 0.25, {-3, 0, 0});
  script.turn(skeleton.hand, kClose, 0.5, {});
  script.turn(skeleton.forearm_twist, 0.2, 1.5, {0, -8, 0});
  script.turn(skeleton.forearm_twist, 1.8, 1.2, {0, 8, 0});
  script.turn(skeleton.forearm_twist, 3.2, 0.75, {});
  return script.play("count", 4);
}

/// As long as the animation of GFW06: four fingers roll in one after another.
RigClip beckon(const HandSkeleton& skeleton) {
  Script script(skeleton, kOpen);
  for (std::size_t d = 1; d < kDigits; ++d) {
    const double wave = 0.06 * static_cast<double>(kDigits - 1 - d);
    script.move_digit(d, 0.02 + wave, 0.36, kFist[d]);
    script.move_digit(d, 0.48 + 0.04 * static_cast<double>(d - 1), 0.34, kOpen[d]);
  }
  script.turn(skeleton.hand, 0.0, 0.4, {22, 0, 3});
  script.turn(skeleton.hand, 0.45, 0.5, {});
  script.turn(skeleton.forearm_twist, 0.0, 0.5, {0, -18, 0});
  script.turn(skeleton.forearm_twist, 0.5, 0.42, {});
  return script.play("beckon", 29 / kKeysPerSecond);
}

}  // namespace

std::vector<RigClip> make_hand_clips(const HandSkeleton& skeleton) {
  return {grasp(skeleton), count(skeleton), beckon(skeleton)};
}

}  // namespace mdk
