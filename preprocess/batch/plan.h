// Turns a manifest into jobs: looks up patterns, fills in names, cuts long sequences.
#pragma once

#include <vector>

#include "preprocess/batch/job.h"
#include "preprocess/batch/manifest.h"

namespace mdk {

/// Bakes, then verifies, then renders, each in the manifest's order and files sorted by bytes. A
/// verify's or render's pattern is matched with what is baked here, and only where it names none of
/// that with the files there are. Throws Error (kBadInput) naming the place: a pattern that names
/// no file, two jobs with one output, an option that the command does not have.
std::vector<Job> plan_jobs(const Manifest& manifest);

}  // namespace mdk
