// How the time of a bake divides among reading, decomposing and writing, predicted before anything
// is read: so that progress rises evenly from its start. What is shown depends on it, no result
// does.
#pragma once

#include "preprocess/cli/source_reader.h"
#include "preprocess/pipeline.h"

namespace mdk {

/// Where reading and decomposing end, as shares of the whole; what is left is for writing.
struct JobEnds {
  double read = 0, decomposed = 0;
};

/// Looks at the sizes of two files at most. A file that is not there counts as empty.
JobEnds predict_job_ends(const Source& source, const DecomposeOptions& options);

}  // namespace mdk
