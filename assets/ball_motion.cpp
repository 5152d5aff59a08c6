// The motion is a list of phases: flights along parabolas, contacts during which the ball is
// squashed along a tilted axis (its foot sticks, its top goes on: it shears), and a last roll.
#include "assets/ball_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mdk {
namespace {

constexpr double kKeysPerSecond = 30;
constexpr double kDegrees = 180 / std::numbers::pi;

enum class Phase { kFall, kFlight, kContact, kRoll };

struct Segment {
  Phase phase;
  double seconds;
  double x_end;
  double size;  ///< height of the flight in centimetres, or the share of height lost in a contact
  double tilt;  ///< of the squashed axis, degrees
  double turn;  ///< how far the ball spins, degrees
};

/// Half the height of a ball stretched along a tilted axis.
double half_height(const BallPose& pose) {
  const double t = pose.tilt / kDegrees;
  const double along = pose.stretch * std::cos(t), across = std::sin(t) / std::sqrt(pose.stretch);
  return kBallRadius * std::sqrt(along * along + across * across);
}

/// Speed draws the ball out along its path, but not where it touches the floor.
void stretch_in_flight(const Segment& s, double u, double rise, double run, BallPose& pose) {
  constexpr double kStretchPerSpeed = 0.0009;  // per cm/s
  constexpr double kFade = 0.08;               // seconds
  const double start = s.phase == Phase::kFall ? 1 : std::min(u * s.seconds / kFade, 1.0);
  const double end = std::min((1 - u) * s.seconds / kFade, 1.0);
  const double speed = std::sqrt(rise * rise + run * run) / s.seconds;
  pose.stretch = 1 + kStretchPerSpeed * speed * start * end;
  // A path downwards to the right and one upwards to the left stretch alike: keep within a quarter
  // turn of +y, so that the axis swings smoothly through the top of the arc.
  pose.tilt = rise == 0 ? 0 : std::clamp(-std::atan(run / rise) * kDegrees, -80.0, 80.0);
  if (std::abs(rise) < std::abs(run)) pose.stretch = 1 + (pose.stretch - 1) * std::abs(rise / run);
}

BallPose pose_in(const Segment& s, double u, double x_start) {
  BallPose pose;
  const double run = s.x_end - x_start;
  double lift = 0, travelled = u;
  switch (s.phase) {
    case Phase::kFall:
      lift = s.size * (1 - u * u);
      stretch_in_flight(s, u, -2 * s.size * u, run, pose);
      break;
    case Phase::kFlight:
      lift = 4 * s.size * u * (1 - u);
      stretch_in_flight(s, u, 4 * s.size * (1 - 2 * u), run, pose);
      break;
    case Phase::kContact:
      pose.stretch = 1 - s.size * std::sin(std::numbers::pi * u);
      pose.tilt = s.tilt;
      break;
    case Phase::kRoll:
      travelled = 1 - (1 - u) * (1 - u);
      break;
  }
  pose.spin = s.turn * travelled;
  pose.center = {x_start + run * travelled, lift + half_height(pose), 0};
  return pose;
}

BallClip play(const std::string& name, double x_start, const std::vector<Segment>& segments) {
  BallClip clip{name, {}, {}};
  double seconds = 0;
  for (const Segment& s : segments) seconds += s.seconds;
  const int keys = static_cast<int>(std::lround(seconds * kKeysPerSecond)) + 1;
  std::size_t i = 0;
  double began = 0, spun = 0;
  for (int k = 0; k < keys; ++k) {
    const double t = k / kKeysPerSecond;
    while (i + 1 < segments.size() && t > began + segments[i].seconds) {
      began += segments[i].seconds;
      spun += segments[i].turn;
      x_start = segments[i].x_end;
      ++i;
    }
    BallPose pose = pose_in(segments[i], std::min((t - began) / segments[i].seconds, 1.0), x_start);
    pose.spin += spun;
    clip.times.push_back(t);
    clip.poses.push_back(pose);
  }
  return clip;
}

}  // namespace

std::vector<BallClip> make_ball_clips() {
  const double rolled = 11 / kBallRadius * kDegrees;
  const std::vector<Segment> thrown = {
      {Phase::kFall, 0.40, -13, 34, 0, -30},       {Phase::kContact, 0.20, -9, 0.42, 12, -12},
      {Phase::kFlight, 0.60, 5, 22, 0, -110},      {Phase::kContact, 0.16, 7, 0.26, 10, -14},
      {Phase::kFlight, 0.34, 12, 7, 0, -50},       {Phase::kContact, 0.10, 13, 0.10, 5, -8},
      {Phase::kRoll, 0.80, 13 + 9, 0, 0, -rolled},
  };
  const std::vector<Segment> bounced = {
      {Phase::kFlight, 0.80, 0, 30, 0, -360},
      {Phase::kContact, 0.20, 0, 0.38, 0, 0},
  };
  return {play("throw", -27, thrown), play("bounce", 0, bounced)};
}

}  // namespace mdk
