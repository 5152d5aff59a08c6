// Whether a model may be traced blindly: everything docs/file-format.md demands of counts, ranges,
// links and numbers. The reader asks it about files from outside, the writer about our own work.
#pragma once

#include <string>

#include "common/motion/model.h"

namespace mdk {

/// Empty, or the first thing that is wrong ("clusters: cluster 3 does not start where the last one
/// ended"). Does not look at positions, texture coordinates, colours or texels. Cost: one pass over
/// everything else.
std::string find_inconsistency(const Model& model);

}  // namespace mdk
