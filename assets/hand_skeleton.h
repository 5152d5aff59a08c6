// The bones of the sample hand: a right hand, fingers up (+y), palm to the front (+z), thumb to +x.
// Lengths are centimetres here and everywhere in this program; the file is written in metres.
#pragma once

#include <array>
#include <vector>

#include "assets/rig.h"

namespace mdk {

inline constexpr int kDigits = 5;     ///< thumb, index, middle, ring, little
inline constexpr int kPhalanges = 3;  ///< joints of a digit; the thumb's first is its metacarpal

struct HandSkeleton {
  std::vector<RigJoint> joints;  ///< parents first; joint 0 is the root
  int forearm = 0, forearm_twist = 0, hand = 0;
  int ring_metacarpal = 0, little_metacarpal = 0;             ///< these cup the palm
  std::array<std::array<int, kPhalanges>, kDigits> digits{};  ///< from the palm to the tip

  const Basis& rest(int joint) const { return joints[static_cast<std::size_t>(joint)].rest; }
  double bone_length(int joint) const { return joints[static_cast<std::size_t>(joint)].length; }
};

/// The skeleton at rest: fingers almost straight and slightly spread.
HandSkeleton make_hand_skeleton();

}  // namespace mdk
