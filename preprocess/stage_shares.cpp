#include "preprocess/stage_shares.h"

namespace mdk {
namespace {

// Seconds as they were measured on models of 2 to 50 million positions (keys times vertices).
// Clusters grow on a sample of bounded size; what comes after looks at every position.
constexpr double kGrow = 1.5, kGrowPerTriangle = 15e-6;
constexpr double kMapPerPosition = 0.5e-6, kPlainMapPerPosition = 0.1e-6;
constexpr double kCutPerPosition = 0.1e-6;
constexpr double kBoxPerPosition = 0.1e-6;
constexpr double kTreePerTriangle = 6e-6;

}  // namespace

StageEnds predict_stage_ends(const PoseSequence& sequence, const DecomposeOptions& options) {
  const auto positions = static_cast<double>(sequence.positions.size());
  const auto triangles = static_cast<double>(sequence.triangles.size());
  const bool grows = options.mode == DecomposeMode::kMotion;
  const double clustered = grows ? kGrow + kGrowPerTriangle * triangles : 0;
  const double mapped =
      clustered + (grows && options.refine ? kMapPerPosition : kPlainMapPerPosition) * positions;
  const double segmented = mapped + (options.segments == 1 ? 0 : kCutPerPosition) * positions;
  const double boxed = segmented + kBoxPerPosition * positions;
  const double all = boxed + kTreePerTriangle * triangles;
  return {clustered / all, mapped / all, segmented / all, boxed / all};
}

}  // namespace mdk
