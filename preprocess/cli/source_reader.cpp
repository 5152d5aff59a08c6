#include "preprocess/cli/source_reader.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "common/base/error.h"
#include "formats/assimp_reader.h"
#include "formats/gltf_reader.h"
#include "formats/mesh_sequence_reader.h"
#include "preprocess/cli/number_text.h"

namespace mdk {

void add_source_options(CLI::App& command, SourceOptions& options) {
  command
      .add_option("--clips", options.clips,
                  "Which animations: all, or names separated by commas (default: all).")
      ->type_name("all|NAME,...");
  command
      .add_option(
          "--fps", options.fps,
          "Keys per second at which skins, morphs and node tracks are sampled, or frames\n"
          "per second of a .pc2 or of numbered files; above 0, at most 10000 (default: 30).")
      ->type_name("N");
}

ReadOptions parse_source_options(const SourceOptions& options) {
  ReadOptions parsed;
  parsed.skeleton = options.skeleton;
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

namespace {

constexpr std::array<std::string_view, 2> kMeshExtensions = {".obj", ".ply"};

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return extension;
}

bool is_gltf(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".gltf" || extension == ".glb";
}
bool is_for_assimp(const std::string& path) {
  const auto extensions = assimp_extensions();
  return std::ranges::find(extensions, extension_of(path)) != extensions.end();
}
bool is_cache(const std::string& path) {
  const std::string extension = extension_of(path);
  return extension == ".pc2" || extension == ".mdd";
}
bool is_mesh(const std::string& path) {
  return std::ranges::find(kMeshExtensions, extension_of(path)) != kMeshExtensions.end();
}

[[noreturn]] void refuse(const std::string& path) {
  if (is_cache(path))
    throw Error(ErrorCode::kUsage,
                path + ": is a point cache; name the mesh it moves, an .obj or .ply, before it");
  const std::string extension = extension_of(path);
  throw bad_input(
      path, (extension.empty() ? "a name without an extension" : "files that end in " + extension) +
                " cannot be read, only .gltf, .glb, .obj, .ply, .fbx, .dae, .md5mesh, .x and a few "
                "more; export the mesh as glTF");
}

Source find_one(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return {SourceKind::kMeshes, numbered_files_in(path, kMeshExtensions), {}};
  if (is_gltf(path)) return {SourceKind::kGltf, {"", {path}, {0}}, {}};
  if (is_for_assimp(path)) return {SourceKind::kThroughAssimp, {"", {path}, {0}}, {}};
  if (!is_mesh(path)) refuse(path);
  if (is_number_pattern(path)) return {SourceKind::kMeshes, files_of_pattern(path), {}};
  Source source{SourceKind::kMeshes, files_from(path), {}};
  if (const std::size_t count = source.files.files.size(); count > 1)
    source.notes.push_back(path + " is read as the first of a sequence, up to " +
                           source.files.files.back());
  return source;
}

}  // namespace

Source find_source(std::span<const std::string> inputs) {
  if (inputs.size() == 1) return find_one(inputs.front());
  if (inputs.size() == 2 && is_mesh(inputs[0]) && is_cache(inputs[1]))
    return {SourceKind::kMeshAndCache, {"", {inputs[0], inputs[1]}, {0, 1}}, {}};
  const auto stands_alone = [](const std::string& path) {
    return is_gltf(path) || is_for_assimp(path);
  };
  if (!stands_alone(inputs.front()) && !is_mesh(inputs.front())) refuse(inputs.front());
  for (const std::string& path : inputs)
    if (extension_of(path) != extension_of(inputs.front()) || stands_alone(path))
      throw Error(ErrorCode::kUsage,
                  inputs[1] +
                      ": several inputs are an .obj or .ply and the .pc2 or .mdd point "
                      "cache that moves it, or files of a sequence, all .obj or all .ply");
  return {SourceKind::kMeshes, listed_files(inputs), {}};
}

ReadResult read_source(const Source& source, const SourceOptions& options, ProgressSink& progress) {
  const ReadOptions parsed = parse_source_options(options);
  const std::vector<std::string>& files = source.files.files;
  if (source.kind == SourceKind::kGltf) return read_gltf(files.front(), parsed, progress);
  if (source.kind == SourceKind::kThroughAssimp)
    return read_with_assimp(files.front(), parsed, progress);
  if (source.kind == SourceKind::kMeshAndCache)
    return read_cached_mesh(files[0], files[1], parsed, progress);
  ReadResult result = read_mesh_sequence(source.files, parsed, progress);
  result.notes.insert(result.notes.begin(), source.notes.begin(), source.notes.end());
  return result;
}

}  // namespace mdk
