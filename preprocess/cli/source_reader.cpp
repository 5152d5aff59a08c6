#include "preprocess/cli/source_reader.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>

#include "common/base/error.h"
#include "preprocess/cli/number_text.h"

namespace mdk {

void add_source_options(CLI::App& command, SourceOptions& options) {
  command
      .add_option("--clips", options.clips,
                  "Which animations: all, or names separated by commas (default: all).")
      ->type_name("all|NAME,...");
  command
      .add_option("--fps", options.fps,
                  "Keys per second at which skins, morphs and node tracks are sampled,\n"
                  "above 0, at most 10000 (default: 30).")
      ->type_name("N");
}

GltfOptions parse_source_options(const SourceOptions& options) {
  GltfOptions parsed;
  parsed.fps = parse_real("--fps", options.fps);
  if (!(parsed.fps > 0 && parsed.fps <= 10000))
    throw Error(ErrorCode::kUsage,
                "--fps " + options.fps + ": expected a number above 0, at most 10000");
  if (options.clips == "all") return parsed;
  parsed.clips = split(options.clips, ',');
  for (const std::string& name : parsed.clips)
    if (name.empty())
      throw Error(ErrorCode::kUsage, "--clips \"" + options.clips +
                                         "\": a name is empty; write all, or names with commas "
                                         "between them");
  return parsed;
}

void require_known_extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  if (extension == ".gltf" || extension == ".glb") return;
  throw bad_input(
      path, (extension.empty() ? "a name without an extension" : "files that end in " + extension) +
                " cannot be read, only .gltf and .glb; export the mesh as glTF");
}

GltfResult read_source(const std::string& path, const SourceOptions& options,
                       ProgressSink& progress) {
  require_known_extension(path);
  return read_gltf(path, parse_source_options(options), progress);
}

}  // namespace mdk
