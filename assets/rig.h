// Bones as a glTF scene holds them: nodes, a skin, and clips of joint angles.
#pragma once

#include <string>
#include <vector>

#include "assets/glb_writer.h"
#include "assets/quaternion.h"

namespace mdk {

/// A joint at rest. Turning about its x bends the bone to its front (z), about z spreads it
/// sideways, about y twists it.
struct RigJoint {
  std::string name;
  int parent = -1;    ///< comes before it
  Basis rest;         ///< in space; y runs along the bone
  double length = 0;  ///< of the bone, to where the next joint sits (or to the tip)
};

/// How far a joint is turned from rest, in degrees: x bends, y twists, z spreads.
using JointAngles = Vec3d;

struct RigClip {
  std::string name;
  std::vector<double> times;                    ///< seconds, one per key
  std::vector<std::vector<JointAngles>> poses;  ///< per key, per joint
  std::vector<Vec3d> root_offsets;              ///< per key, of joint 0; may be empty
};

/// Adds node j for joint j and a skin over all of them to an empty scene. A unit of the joints'
/// bases is `metres` long.
void add_rig(const std::vector<RigJoint>& joints, double metres, GlbScene& scene);

/// Adds the clip to a scene that add_rig began.
void add_rig_clip(const std::vector<RigJoint>& joints, const RigClip& clip, double metres,
                  GlbScene& scene);

/// The rotation from a joint's rest basis: twist first, then bend, then spread.
Quaternion joint_rotation(const JointAngles& degrees);

}  // namespace mdk
