#include "formats/mesh/reader.h"

#include <algorithm>
#include <exception>
#include <filesystem>
#include <utility>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "formats/files/file_kind.h"
#include "formats/files/mapped_file.h"
#include "formats/files/text.h"
#include "formats/mesh/materials.h"
#include "formats/mesh/point_cache.h"
#include "formats/mesh/triangle_mesh.h"

namespace mdk {
namespace {

constexpr std::size_t kMaxPoseBytes = std::size_t{16} << 30;
constexpr std::size_t kFilesPerReport = 16;  // read at a time, and so in memory beside the poses
constexpr double kCopied =
    0.7;  // share of a cache's reading; then vertices are welded in all poses

void require_clip(const std::string& name, const std::string& path, const ReadOptions& options) {
  for (const std::string& wanted : options.clips)
    if (wanted != name)
      throw Error(ErrorCode::kUsage,
                  "--clips " + wanted + ": " + path + " has one clip, \"" + name + "\"");
}

/// Everything but the poses, which stand in `first`, read from `path`.
ReadResult begin_result(const std::string& path, TriangleMesh& first) {
  ReadResult result;
  result.sequence.appearance = read_appearance(path, first, result);
  result.sequence.vertex_count = static_cast<std::uint32_t>(first.vertices.size());
  result.sequence.triangles = std::move(first.triangles);
  return result;
}

void finish(const std::string& clip, PoseSequence& sequence) {
  sequence.clips = {{clip, 0, sequence.key_count()}};
  weld_vertices(sequence, {});
  check_consistency(sequence);
}

/// The faces of a sequence never change; what moves are its vertices.
void require_same_faces(const PoseSequence& first, const std::string& first_path,
                        const TriangleMesh& mesh, const std::string& path) {
  const auto differs = [&](const char* what, std::size_t count, std::size_t wanted) {
    if (count != wanted)
      throw bad_input(path, "has " + std::to_string(count) + " " + what + " where " + first_path +
                                " has " + std::to_string(wanted) +
                                "; every file of a sequence needs the same faces");
  };
  differs("vertices", mesh.vertices.size(), first.vertex_count);
  differs("triangles", mesh.triangles.size(), first.triangles.size());
  const auto [here, there] =
      std::mismatch(mesh.triangles.begin(), mesh.triangles.end(), first.triangles.begin());
  if (here != mesh.triangles.end())
    throw bad_input(path, "its triangle " + std::to_string(here - mesh.triangles.begin()) +
                              " joins other vertices than that of " + first_path +
                              "; every file of a sequence needs the same faces");
}

/// The files [begin, end), or the reason why the first broken one is.
std::vector<TriangleMesh> read_batch(const std::vector<std::string>& files, std::size_t begin,
                                     std::size_t end) {
  std::vector<TriangleMesh> meshes(end - begin);
  std::vector<std::exception_ptr> failures(end - begin);
  parallel_chunks(end - begin, 1, [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      try {
        meshes[i] = read_mesh(files[begin + i], ObjContent::kShape);
      } catch (...) {
        failures[i] = std::current_exception();
      }
    }
  });
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  return meshes;
}

void require_room(const NumberedFiles& sequence, std::size_t vertices) {
  if (sequence.files.size() > kMaxPoseBytes / (vertices * sizeof(Vec3f)))
    throw Error(ErrorCode::kOverLimit,
                sequence.files.front() + ": the " + std::to_string(sequence.files.size()) +
                    " files of its sequence take over 16 GiB; bake them in several parts");
}

}  // namespace

TriangleMesh read_mesh(const std::string& path, ObjContent content) {
  const MappedFile file(path);
  const std::string_view text(reinterpret_cast<const char*>(file.bytes().data()),
                              file.bytes().size());
  return lower_extension(path) == ".ply" ? parse_ply(path, text) : parse_obj(path, text, content);
}

ReadResult read_mesh_sequence(const NumberedFiles& sequence, const ReadOptions& options,
                              ProgressSink& progress) {
  const std::vector<std::string>& files = sequence.files;
  const std::string clip = as_utf8(sequence.name);
  require_clip(clip, files.front(), options);
  progress.report("read", 0);
  TriangleMesh first = read_mesh(files.front(), ObjContent::kShapeAndMaterials);
  require_room(sequence, first.vertices.size());
  ReadResult result = begin_result(files.front(), first);
  PoseSequence& poses = result.sequence;
  poses.positions = PositionList(options.scratch);
  poses.positions.reserve(files.size() * poses.vertex_count);
  poses.positions.assign(first.vertices.begin(), first.vertices.end());

  bool colors_change = false;
  for (std::size_t begin = 1; begin < files.size(); begin += kFilesPerReport) {
    progress.report("read", static_cast<double>(begin) / static_cast<double>(files.size()));
    const std::size_t end = std::min(begin + kFilesPerReport, files.size());
    const std::vector<TriangleMesh> meshes = read_batch(files, begin, end);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      require_same_faces(poses, files.front(), meshes[i], files[begin + i]);
      colors_change |= meshes[i].vertex_colors != first.vertex_colors;
      poses.positions.insert(poses.positions.end(), meshes[i].vertices.begin(),
                             meshes[i].vertices.end());
    }
  }
  for (const std::uint64_t number : sequence.numbers)
    poses.key_times.push_back(static_cast<double>(number - sequence.numbers.front()) / options.fps);
  if (colors_change)
    result.notes.push_back("vertex colours change over time; those of " + files.front() +
                           " are shown");
  if (const std::string gaps = gap_sentence(sequence); !gaps.empty()) result.notes.push_back(gaps);
  finish(clip, poses);
  result.dependencies.insert(result.dependencies.begin(), files.begin(), files.end());
  progress.report("read", 1);
  return result;
}

ReadResult read_cached_mesh(const std::string& mesh, const std::string& cache,
                            const ReadOptions& options, ProgressSink& progress) {
  const std::string name = as_utf8(std::filesystem::path(cache).stem().string());
  require_clip(name, cache, options);
  progress.report("read", 0);
  TriangleMesh first = read_mesh(mesh, ObjContent::kShapeAndMaterials);
  ReadResult result = begin_result(mesh, first);
  ProgressPart copying(progress, 0, kCopied);
  PointCache frames = read_point_cache(
      cache, {options.fps, result.sequence.vertex_count, options.scratch}, copying);
  result.sequence.key_times = std::move(frames.key_times);
  result.sequence.positions = std::move(frames.positions);
  finish(name, result.sequence);
  result.dependencies.insert(result.dependencies.begin(), {mesh, cache});
  progress.report("read", 1);
  return result;
}

}  // namespace mdk
