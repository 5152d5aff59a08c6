#include "preprocess/cli/source_reader.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/base/error.h"
#include "formats/obj_reader.h"
#include "formats/point_cache_reader.h"
#include "preprocess/cli/number_text.h"

namespace mdk {

void add_source_options(CLI::App& command, SourceOptions& options) {
  command
      .add_option("--clips", options.clips,
                  "Which animations: all, or names separated by commas (default: all).")
      ->type_name("all|NAME,...");
  command
      .add_option("--fps", options.fps,
                  "Keys per second at which skins, morphs and node tracks are sampled, or frames\n"
                  "per second of a .pc2; above 0, at most 10000 (default: 30).")
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

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return extension;
}

bool is_gltf(const std::string& extension) { return extension == ".gltf" || extension == ".glb"; }
bool is_cache(const std::string& extension) { return extension == ".pc2" || extension == ".mdd"; }

Appearance appearance_of(const ObjMesh& mesh) {
  Appearance appearance;
  appearance.materials.emplace_back();
  appearance.triangle_materials.assign(mesh.triangles.size(), 0);
  if (mesh.vertex_colors.empty()) return appearance;
  for (float& channel : appearance.materials.front().base_color) channel = 1;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle.v)
      appearance.corner_colors.push_back(mesh.vertex_colors[v]);
  return appearance;
}

ReadResult read_obj_source(std::span<const std::string> paths, const ReadOptions& options,
                           ProgressSink& progress) {
  const std::string name = std::filesystem::path(paths.back()).stem().string();
  for (const std::string& wanted : options.clips)
    if (wanted != name)
      throw Error(ErrorCode::kUsage,
                  "--clips " + wanted + ": " + paths.back() + " has one clip, \"" + name + "\"");
  progress.report("read", 0);
  ObjMesh mesh = read_obj(paths.front());
  ReadResult result;
  PoseSequence& sequence = result.sequence;
  sequence.appearance = appearance_of(mesh);
  sequence.vertex_count = static_cast<std::uint32_t>(mesh.vertices.size());
  if (paths.size() == 1) {
    sequence.key_times = {0};
    sequence.positions = std::move(mesh.vertices);
  } else {
    PointCache cache =
        read_point_cache(paths.back(), {options.fps, sequence.vertex_count}, progress);
    sequence.key_times = std::move(cache.key_times);
    sequence.positions = std::move(cache.positions);
  }
  sequence.clips = {{name, 0, sequence.key_count()}};
  sequence.triangles = std::move(mesh.triangles);
  weld_vertices(sequence, {});
  check_consistency(sequence);
  result.dependencies.assign(paths.begin(), paths.end());
  result.notes = std::move(mesh.notes);
  return result;
}

}  // namespace

void require_known_source(std::span<const std::string> paths) {
  const std::string& path = paths.front();
  const std::string extension = extension_of(path);
  if (is_cache(extension))
    throw Error(ErrorCode::kUsage,
                path + ": is a point cache; name the mesh it moves, an .obj, before it");
  if (!is_gltf(extension) && extension != ".obj")
    throw bad_input(
        path,
        (extension.empty() ? "a name without an extension" : "files that end in " + extension) +
            " cannot be read, only .gltf, .glb and .obj; export the mesh as glTF");
  if (paths.size() == 1) return;
  if (paths.size() > 2 || extension != ".obj" || !is_cache(extension_of(paths[1])))
    throw Error(ErrorCode::kUsage, paths[1] +
                                       ": only an .obj takes a second input, the .pc2 or .mdd "
                                       "point cache that moves it; leave it out");
}

ReadResult read_source(std::span<const std::string> paths, const SourceOptions& options,
                       ProgressSink& progress) {
  require_known_source(paths);
  const ReadOptions parsed = parse_source_options(options);
  if (is_gltf(extension_of(paths.front()))) return read_gltf(paths.front(), parsed, progress);
  return read_obj_source(paths, parsed, progress);
}

}  // namespace mdk
