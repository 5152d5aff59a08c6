#include "preprocess/cli/source_reader.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <system_error>

#include "common/base/error.h"
#include "formats/assimp_reader.h"
#include "formats/file_kind.h"
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
  parsed.scratch = options.scratch;
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

bool stands_alone(const std::string& path) {
  const FileKind kind = file_kind(path);
  return kind == FileKind::kGltf || kind == FileKind::kForAssimp;
}

[[noreturn]] void refuse(const std::string& path) {
  if (file_kind(path) == FileKind::kPointCache)
    throw Error(ErrorCode::kUsage,
                path + ": is a point cache; name the mesh it moves, an .obj or .ply, before it");
  const std::string extension = lower_extension(path);
  throw bad_input(
      path, (extension.empty() ? "a name without an extension" : "files that end in " + extension) +
                " cannot be read, only .gltf, .glb, .obj, .ply, .fbx, .dae, .md5mesh, .x and a few "
                "more; export the mesh as glTF");
}

Source find_one(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return {SourceKind::kMeshes, numbered_files_in(path, extensions_of(FileKind::kMesh)), {}};
  const FileKind kind = file_kind(path);
  if (kind == FileKind::kGltf) return {SourceKind::kGltf, {"", {path}, {0}}, {}};
  if (kind == FileKind::kForAssimp) return {SourceKind::kThroughAssimp, {"", {path}, {0}}, {}};
  if (kind != FileKind::kMesh) refuse(path);
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
  const bool meshes_come = file_kind(inputs.front()) == FileKind::kMesh;
  if (meshes_come && inputs.size() == 2 && file_kind(inputs[1]) == FileKind::kPointCache)
    return {SourceKind::kMeshAndCache, {"", {inputs[0], inputs[1]}, {0, 1}}, {}};
  if (!meshes_come && !stands_alone(inputs.front())) refuse(inputs.front());
  for (const std::string& path : inputs)
    if (lower_extension(path) != lower_extension(inputs.front()) || stands_alone(path))
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
