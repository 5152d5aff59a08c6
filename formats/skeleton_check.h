// What docs/file-format.md says about skeletons.
#pragma once

#include <string>

#include "common/motion/model.h"

namespace mdk {

/// The first fault as a sentence that begins with the section's name, or nothing. Relies on sound
/// poses.
std::string check_skeleton(const Model& model);

}  // namespace mdk
