#include "preprocess/cli/job_shares.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>

#include "preprocess/stage_shares.h"

namespace mdk {
namespace {

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
