// Reads meshes that plain files move: an .obj or .ply for each key, or one and its point cache.
#pragma once

#include <string>

#include "common/base/parallel.h"
#include "formats/mesh/numbered_files.h"
#include "formats/reading.h"

namespace mdk {

/// One clip, called like the sequence; key i is at (number i - first number) / fps, so that a
/// missing file leaves its gap in time. Every file must have the first one's triangles; its colours
/// and materials are taken. Throws Error as read_obj and read_ply do: kBadInput, too, for a file
/// whose triangles differ (named), kOverLimit where the poses take over 16 GiB, kUsage where
/// `clips` names another clip. Files are read in parallel; the first broken one is reported.
ReadResult read_mesh_sequence(const NumberedFiles& sequence, const ReadOptions& options,
                              ProgressSink& progress);

/// One clip, called like the cache without its extension.
ReadResult read_cached_mesh(const std::string& mesh, const std::string& cache,
                            const ReadOptions& options, ProgressSink& progress);

}  // namespace mdk
