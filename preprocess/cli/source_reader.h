// Reads an animated mesh of any kind that is understood, by the extensions of its names.
#pragma once

#include <span>
#include <string>

#include "common/base/progress.h"
#include "formats/gltf_reader.h"

namespace CLI {
class App;
}

namespace mdk {

struct SourceOptions {
  std::string clips = "all";
  std::string fps = "30";
  bool skeleton = false;  ///< what ReadOptions::skeleton says; no option of the command line
};
void add_source_options(CLI::App& command, SourceOptions& options);

/// Throws Error (kUsage) for a rate out of range or an empty clip name.
ReadOptions parse_source_options(const SourceOptions& options);

/// One file (.gltf, .glb, .obj), or a mesh and the cache that moves it (.obj, then .pc2 or .mdd).
/// Throws Error, naming what is read: kBadInput for one name that is not, kUsage for names that do
/// not go together. Nothing is opened.
void require_known_source(std::span<const std::string> paths);

/// An .obj is one clip, named like the cache without its extension; alone, one key. Throws what
/// require_known_source and the format's reader throw, and Error (kUsage) where --clips names
/// another clip.
ReadResult read_source(std::span<const std::string> paths, const SourceOptions& options,
                       ProgressSink& progress);

}  // namespace mdk
