// Whether a model's key poses can be decoded.
#pragma once

#include <string>

#include "common/motion/model.h"

namespace mdk {

/// The first fault as a sentence that starts with the name of a list, or nothing. Relies on the
/// counts of vertices and keys being at least 1 and below 2^30. Key positions may hold anything and
/// are not looked at. Cost: a pass over the lists of a rig.
std::string check_poses(const Model& model);

}  // namespace mdk
