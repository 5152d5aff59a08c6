#include "preprocess/commands/source.h"

#include <cstdint>
#include <filesystem>
#include <system_error>

#include "common/base/error.h"
#include "formats/assimp/reader.h"
#include "formats/files/file_kind.h"
#include "formats/gltf/reader.h"
#include "formats/mesh/reader.h"
#include "preprocess/pipeline.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

/// None for all of them.
std::vector<std::string> parse_clips(std::string_view text) {
  if (text == "all") return {};
  const std::vector<std::string> names = split(text, ',');
  for (const std::string& name : names)
    if (name.empty())
      throw Error(ErrorCode::kUsage,
                  "a name is empty; write all, or names with commas between them");
  return names;
}

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

// Of a glTF the size tells little: a few kilobytes of track may be a thousand keys. They are read
// fast, whatever they hold.
constexpr JobEnds kOfGltf = {0.03, 0.97};

// Measured, as those of preprocess/stage_shares.cpp.
constexpr double kParsePerByte = 8e-9;
constexpr double kCopyPerPosition = 0.055e-6;
constexpr double kWrite = 0.02, kWritePerPosition = 0.02e-6;

constexpr double kTextPerTriangle = 30;  // bytes; for each there are half a vertex and a face
constexpr double kCachePerPosition = 12;

double bytes_of(const std::string& file) {
  std::error_code problem;
  const std::uintmax_t bytes = std::filesystem::file_size(file, problem);
  return problem ? 0 : static_cast<double>(bytes);
}

}  // namespace

void add_source_options(Command& command, ReadOptions& options) {
  command
      .add_value("--clips", "all|NAME,...",
                 "Which animations: all, or names separated by commas (default: all).", "all",
                 options.clips, parse_clips)
      .with(OptionEffect::kName);
  command.add_value(
      "--fps", "N",
      "Keys per second at which skins, morphs and node tracks are sampled, or frames\n"
      "per second of a .pc2 or of numbered files; above 0, at most 10000 (default: 30).",
      "30", options.fps,
      real_where([](double x) { return x > 0 && x <= 10000; }, "a number above 0, at most 10000"));
}

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

ReadResult read_source(const Source& source, const ReadOptions& options, ProgressSink& progress) {
  const std::vector<std::string>& files = source.files.files;
  if (source.kind == SourceKind::kGltf) return read_gltf(files.front(), options, progress);
  if (source.kind == SourceKind::kThroughAssimp)
    return read_with_assimp(files.front(), options, progress);
  if (source.kind == SourceKind::kMeshAndCache)
    return read_cached_mesh(files[0], files[1], options, progress);
  ReadResult result = read_mesh_sequence(source.files, options, progress);
  result.notes.insert(result.notes.begin(), source.notes.begin(), source.notes.end());
  return result;
}

JobEnds predict_job_ends(const Source& source, const DecomposeOptions& options) {
  const std::vector<std::string>& files = source.files.files;
  if (source.kind != SourceKind::kMeshes && source.kind != SourceKind::kMeshAndCache)
    return kOfGltf;
  const double mesh_bytes = bytes_of(files.front());
  SequenceSize size;
  size.triangles = mesh_bytes / kTextPerTriangle;
  double read = 0;
  if (source.kind == SourceKind::kMeshAndCache) {
    size.positions = bytes_of(files.back()) / kCachePerPosition;
    read = kParsePerByte * mesh_bytes + kCopyPerPosition * size.positions;
  } else {
    const auto count = static_cast<double>(files.size());
    size.positions = size.triangles / 2 * count;
    read = kParsePerByte * mesh_bytes * count;
  }
  const double decomposed = read + predict_decompose_seconds(size, options);
  const double all = decomposed + kWrite + kWritePerPosition * size.positions;
  return {read / all, decomposed / all};
}

}  // namespace mdk
