// Reads an animated mesh of any kind that is understood, by the extensions of its names.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "common/base/progress.h"
#include "formats/numbered_files.h"
#include "formats/reading.h"

namespace CLI {
class App;
}

namespace mdk {

struct SourceOptions {
  std::string clips = "all";
  std::string fps = "30";
  bool skeleton = false;      ///< what ReadOptions::skeleton says; no option of the command line
  ScratchSpace scratch = {};  ///< what ReadOptions::scratch says; likewise
};
void add_source_options(CLI::App& command, SourceOptions& options);

/// Throws Error (kUsage) for a rate out of range or an empty clip name.
ReadOptions parse_source_options(const SourceOptions& options);

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
ReadResult read_source(const Source& source, const SourceOptions& options, ProgressSink& progress);

}  // namespace mdk
