// How a soft ball flies, hits a floor, gives way and jumps off again.
#pragma once

#include <string>
#include <vector>

#include "assets/quaternion.h"

namespace mdk {

inline constexpr double kBallRadius = 9;  ///< centimetres

/// The ball at one moment: place * stretch along a tilted axis * spin, seen from the side (all in
/// the x-y plane).
struct BallPose {
  Vec3d center;        ///< centimetres, the floor at y = 0
  double tilt = 0;     ///< degrees from +y to the stretched axis, counter-clockwise
  double stretch = 1;  ///< along that axis; the other two shrink so that the volume stays
  double spin = 0;     ///< degrees
};

struct BallClip {
  std::string name;
  std::vector<double> times;  ///< seconds, 30 keys each
  std::vector<BallPose> poses;
};

/// "throw" (2.6 s: flies in, hits the floor at a slant, bounces on and rolls out) and "bounce"
/// (1 s, on the spot, loops).
std::vector<BallClip> make_ball_clips();

}  // namespace mdk
