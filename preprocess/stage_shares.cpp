#include "preprocess/stage_shares.h"

namespace mdk {
namespace {

// Seconds as they were measured on models of 2 to 450 million positions (keys times vertices).
// Clusters grow on a sample of bounded size; what comes after looks at every position.
constexpr double kGrow = 1.5, kGrowPerTriangle = 15e-6;
constexpr double kMapPerPosition = 0.5e-6, kPlainMapPerPosition = 0.1e-6;
constexpr double kNoMapPerPosition = 0.01e-6;  // its residuals alone
constexpr double kOrderPerPosition = 0.015e-6;
constexpr double kCutPerPosition = 0.1e-6;
constexpr double kBoxPerPosition = 0.1e-6;
constexpr double kTreePerTriangle = 6e-6;

double map_seconds_per_position(const DecomposeOptions& options) {
  if (options.mode == DecomposeMode::kNone) return kNoMapPerPosition;
  return options.mode == DecomposeMode::kMotion && options.refine ? kMapPerPosition
                                                                  : kPlainMapPerPosition;
}

/// When each stage ends, in seconds; after the last field come the trees.
StageEnds stage_end_seconds(const SequenceSize& size, const DecomposeOptions& options) {
  StageEnds ends;
  if (options.mode == DecomposeMode::kMotion)
    ends.clustered = kGrow + kGrowPerTriangle * size.triangles;
  ends.mapped = ends.clustered + map_seconds_per_position(options) * size.positions;
  ends.ordered = ends.mapped + kOrderPerPosition * size.positions;
  ends.segmented = ends.ordered + (options.segments == 1 ? 0 : kCutPerPosition) * size.positions;
  ends.boxed = ends.segmented + kBoxPerPosition * size.positions;
  return ends;
}

}  // namespace

double predict_decompose_seconds(const SequenceSize& size, const DecomposeOptions& options) {
  return stage_end_seconds(size, options).boxed + kTreePerTriangle * size.triangles;
}

StageEnds predict_stage_ends(const SequenceSize& size, const DecomposeOptions& options) {
  const StageEnds ends = stage_end_seconds(size, options);
  const double all = predict_decompose_seconds(size, options);
  return {ends.clustered / all, ends.mapped / all, ends.ordered / all, ends.segmented / all,
          ends.boxed / all};
}

}  // namespace mdk
