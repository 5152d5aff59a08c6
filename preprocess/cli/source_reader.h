// Reads an animated mesh of any kind that is understood, by the extension of its name.
#pragma once

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
};
void add_source_options(CLI::App& command, SourceOptions& options);

/// Throws Error (kUsage) for a rate out of range or an empty clip name.
GltfOptions parse_source_options(const SourceOptions& options);

/// Throws Error (kBadInput) naming the extension and what is read; nothing is opened.
void require_known_extension(const std::string& path);

/// Throws what the format's reader throws.
GltfResult read_source(const std::string& path, const SourceOptions& options,
                       ProgressSink& progress);

}  // namespace mdk
