// What a bake reads: an animated mesh of any kind that is understood, by the extensions of its
// names; and how long it will take, as a share of the whole bake.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "formats/mesh/numbered_files.h"
#include "formats/reading.h"
#include "preprocess/pipeline.h"
#include "preprocess/tool/command.h"

namespace mdk {

/// --clips and --fps.
void add_source_options(Command& command, ReadOptions& options);

enum class SourceKind { kGltf, kThroughAssimp, kMeshAndCache, kMeshes };

/// What the names on the command line stand for.
struct Source {
  SourceKind kind = SourceKind::kGltf;
  NumberedFiles files;             ///< all that were named or found
  std::vector<std::string> notes;  ///< what was found beside what was named
};

/// A file (.gltf, .glb, or one that Assimp reads); a mesh (.obj, .ply) and the cache that moves it
/// (.pc2, .mdd); or meshes: a folder, 'walk_####.obj', several files, or one file, which those
/// numbered after it follow. Looks into folders and opens no file. Throws Error, naming what is
/// read: kBadInput for a name that is not, kUsage for names that do not go together, and what
/// numbered_files.h throws.
Source find_source(std::span<const std::string> inputs);

/// Throws what the format's reader throws.
ReadResult read_source(const Source& source, const ReadOptions& options, ProgressSink& progress);

/// Where reading and decomposing end, as shares of the whole bake; what is left is for writing.
struct JobEnds {
  double read = 0, decomposed = 0;
};

/// Predicted before anything is read, so that progress rises evenly from its start: what is shown
/// depends on it, no result does. Looks at the sizes of two files at most. A file that is not there
/// counts as empty.
JobEnds predict_job_ends(const Source& source, const DecomposeOptions& options);

}  // namespace mdk
