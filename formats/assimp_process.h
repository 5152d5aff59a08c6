// One run of mdk-assimp.
#pragma once

#include <string>

#include "common/base/parallel.h"
#include "formats/assimp_answer.h"

namespace mdk {

/// Runs mdk-assimp on the file and waits. `progress` is asked for leave several times a second:
/// what it throws ends the run. Throws Error: its own sentence and code where it gives one;
/// kBadInput where the file makes it crash, kOverLimit where it ran out of time, kIo where it is
/// not there.
AssimpAnswer run_assimp(const std::string& path, ProgressSink& progress);

}  // namespace mdk
