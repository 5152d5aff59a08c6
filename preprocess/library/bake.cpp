// mdk/bake.h: a mesh in memory becomes a PoseSequence, and that a model.
#include "mdk/bake.h"

#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "common/base/parallel.h"
#include "common/motion/model_handle.h"
#include "formats/mdk/writer.h"
#include "mdk/error.h"
#include "preprocess/pipeline.h"

namespace mdk {
namespace {

constexpr std::size_t kMostPositions = std::size_t{1} << 36;

[[noreturn]] void refuse(ErrorCode code, const std::string& sentence) {
  throw Error(code, sentence);
}

void require_counts(const BakeMesh& mesh) {
  constexpr std::size_t kMost = std::numeric_limits<std::uint32_t>::max() / 3;
  const std::pair<std::size_t, const char*> counts[] = {
      {mesh.key_count, "keys"}, {mesh.vertex_count, "vertices"}, {mesh.triangle_count, "faces"}};
  for (const auto& [count, noun] : counts) {
    if (count == 0) refuse(ErrorCode::kBadInput, std::string("the mesh has no ") + noun);
    if (count > kMost)
      refuse(ErrorCode::kOverLimit, "the mesh has " + std::to_string(count) + " " + noun +
                                        ", more than " + std::to_string(kMost));
  }
  if (mesh.key_count > kMostPositions / mesh.vertex_count)
    refuse(ErrorCode::kOverLimit, "the mesh has more than 2^36 positions, keys times vertices");
  if (mesh.vertices == nullptr) refuse(ErrorCode::kUsage, "vertices: the list is missing");
  if (mesh.triangles == nullptr) refuse(ErrorCode::kUsage, "faces: the list is missing");
}

void set_times(const BakeMesh& mesh, PoseSequence& sequence) {
  sequence.key_times.resize(mesh.key_count);
  if (mesh.key_times == nullptr) {
    if (!(mesh.fps >= 1e-9) || !(mesh.fps <= 1e9))
      refuse(ErrorCode::kUsage, "fps must be from 1e-9 to 1e9");
    for (std::size_t k = 0; k < mesh.key_count; ++k)
      sequence.key_times[k] = static_cast<double>(k) / mesh.fps;
    return;
  }
  for (std::size_t k = 0; k < mesh.key_count; ++k) {
    const double time = mesh.key_times[k];
    if (!std::isfinite(time) || !std::isfinite(time - mesh.key_times[0]))
      refuse(ErrorCode::kBadInput, "key times: number " + std::to_string(k) + " is not finite");
    sequence.key_times[k] = time - mesh.key_times[0];
    if (k > 0 && !(sequence.key_times[k] > sequence.key_times[k - 1]))
      refuse(ErrorCode::kBadInput,
             "key times: number " + std::to_string(k) + " does not come after the one before");
  }
}

void set_triangles(const BakeMesh& mesh, PoseSequence& sequence) {
  sequence.triangles.resize(mesh.triangle_count);
  for (std::size_t t = 0; t < mesh.triangle_count; ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[3 * t + k];
      if (v >= mesh.vertex_count)
        refuse(ErrorCode::kBadInput, "faces: face " + std::to_string(t) + " names vertex " +
                                         std::to_string(v) + " of " +
                                         std::to_string(mesh.vertex_count));
      sequence.triangles[t].v[k] = v;
    }
}

void set_positions(const BakeMesh& mesh, PoseSequence& sequence) {
  const std::size_t count = mesh.key_count * mesh.vertex_count;
  sequence.positions.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float* p = mesh.vertices + 3 * i;
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      refuse(ErrorCode::kBadInput, "vertices: vertex " + std::to_string(i % mesh.vertex_count) +
                                       " of key " + std::to_string(i / mesh.vertex_count) +
                                       " is not finite");
    sequence.positions[i] = {p[0], p[1], p[2]};
  }
}

PoseSequence sequence_of(const BakeMesh& mesh) {
  require_counts(mesh);
  PoseSequence sequence;
  sequence.vertex_count = static_cast<std::uint32_t>(mesh.vertex_count);
  set_times(mesh, sequence);
  set_triangles(mesh, sequence);
  set_positions(mesh, sequence);
  sequence.clips = {{mesh.clip_name, 0, static_cast<std::uint32_t>(mesh.key_count)}};
  sequence.appearance.materials.emplace_back();
  sequence.appearance.triangle_materials.assign(mesh.triangle_count, 0);
  weld_vertices(sequence, {});
  return sequence;
}

}  // namespace

Model bake(const BakeMesh& mesh, const BakeOptions& options) {
  const ThreadLimit limit(
      static_cast<int>(std::min<unsigned>(options.threads, std::numeric_limits<int>::max())));
  DecomposeOptions request;
  request.clusters = options.clusters;
  request.segments = options.segments;
  if (!(options.quantize >= 0 && options.quantize <= 1))
    refuse(ErrorCode::kUsage, "quantize must be from 0 to 1");
  if (options.quantize > 0) request.quantize = options.quantize;
  SilentProgress silent;
  const auto model =
      std::make_shared<const ModelStorage>(decompose(sequence_of(mesh), request, silent).model);
  return ModelHandle::make(model->view(), model);
}

void save(const Model& model, const std::string& path) {
  write_mdk(ModelHandle::view(model), path);
}

}  // namespace mdk
