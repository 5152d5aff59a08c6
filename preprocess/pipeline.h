// From a pose sequence to a model: Algorithm 1 of GFW06 and what surrounds it, top to bottom.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/decomposition.h"
#include "preprocess/options.h"

namespace mdk {

struct DecomposeStats {
  std::uint32_t rest_key = 0;
  std::string stop_reason;  ///< see stop_reason_id
  double residual_rms = 0;  ///< over all keys, relative to the rest pose's diagonal
  double residual_max = 0;
  std::optional<QuantizationError> quantization;  ///< where poses were quantised
  double sah_cost = 0;     ///< expected work per ray that hits the model (docs/method.md, cost)
  double refine_gain = 0;  ///< share by which refinement lowered the summed area of fuzzy boxes
  std::vector<GrowthStep> steps;   ///< residuals relative to the rest pose's diagonal
  std::vector<std::string> notes;  ///< sentences on what could not be done as asked
  double decompose_seconds = 0, build_seconds = 0;
};

struct DecomposeResult {
  ModelStorage model;
  DecomposeStats stats;
};

/// Consumes the sequence (its positions move into the model). The result depends on the input and
/// options alone, not on the thread count or instruction set. Throws Error as validate() does
/// (options.h), kUsage where poses cannot be quantised so finely, kOverLimit where the model is too
/// large.
DecomposeResult decompose(PoseSequence sequence, const DecomposeOptions& options,
                          ProgressSink& progress);

/// How large a sequence is, or is taken to be before it is read.
struct SequenceSize {
  double positions = 0;  ///< keys times vertices
  double triangles = 0;
};

/// How long decompose() takes on one core of a common machine. Only ratios count: what is shown of
/// progress depends on it, no result does.
double predict_decompose_seconds(const SequenceSize& size, const DecomposeOptions& options);

/// Where each stage ends, as a share of the whole, in this order; after `boxed` the fuzzy kd-trees
/// are built.
struct StageEnds {
  double clustered = 0, mapped = 0, ordered = 0, segmented = 0, boxed = 0;
};

StageEnds predict_stage_ends(const SequenceSize& size, const DecomposeOptions& options);

}  // namespace mdk
