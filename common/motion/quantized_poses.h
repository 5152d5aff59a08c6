// Quantised poses: each cluster's vertices stay near where they rest in its local basis, so what is
// left of a pose takes few bits. A vertex of a run of vertices is at a key
//
//     p = M * (base + step * q)
//
// with a 3x4 matrix M and three steps per run and key, and whole numbers q of up to 16 bits for
// each coordinate.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/scratch.h"
#include "common/math/affine3.h"
#include "common/math/vec3.h"
#include "common/motion/rig.h"

namespace mdk {

inline constexpr std::uint32_t kMaxCoordinateBits = 16;

/// A run of vertices at a key. 72 bytes, as the file holds it.
struct QuantizedBlock {
  Affine3f world_from_local;
  Vec3f step;
  std::uint8_t bits[3] = {0, 0, 0};  ///< of each coordinate, at most 16
  std::uint8_t reserved = 0;
  std::uint64_t first_bit = 0;  ///< in the words, counted from the lowest bit of word 0

  std::uint32_t bits_per_vertex() const { return std::uint32_t{bits[0]} + bits[1] + bits[2]; }
};

/// How far decoded poses are from what was read, in units of the rest pose's diagonal.
struct QuantizationError {
  double bound = 0;    ///< asked for
  double largest = 0;  ///< of all that were decoded
};

/// V vertices in R runs, F keys. `List<T>` is a span or a vector, `LargeList<T>` one that may stand
/// in a file.
template <template <class> class List, template <class> class LargeList = List>
struct QuantizedLists {
  List<QuantizationError> error;     ///< one
  List<std::uint32_t> first_vertex;  ///< R + 1: run r has [first_vertex[r], first_vertex[r + 1])
  List<Vec3f> rest_positions;        ///< V: base, in the local basis of the vertex's run
  List<QuantizedBlock> blocks;       ///< F * R, key-major
  LargeList<std::uint32_t> words;    ///< coordinates one after another, and one word more

  /// See RigLists.
  template <class Visit, class... Poses>
  static void for_each_array(Visit&& visit, Poses&... poses) {
    using enum Count;
    using namespace count_rules;
    constexpr ModelPart kPart = ModelPart::kQuantized;
    visit(array_row("QERR", "quantization_error", exactly(kOne), kPart), poses.error...);
    visit(array_row("QRUN", "first_vertex", some(2), kPart), poses.first_vertex...);
    visit(array_row("QRES", "rest_positions", exactly(kVertices), kPart), poses.rest_positions...);
    visit(array_row("QBLK", "quantized_blocks", exactly(kKeys, kRuns), kPart), poses.blocks...);
    visit(array_row("QBIT", "quantized_words", any(), kPart), poses.words...);
  }

  /// Valid while this lives and is not changed.
  QuantizedLists<ConstSpan> view() const {
    QuantizedLists<ConstSpan> poses;
    for_each_array(kAssign, poses, *this);
    return poses;
  }
};

using QuantizedView = QuantizedLists<ConstSpan>;
/// Quantised poses that own their arrays.
using QuantizedPoses = QuantizedLists<OwnedList, ScratchList>;

/// World positions of a range of vertices at a key; `out` has one per vertex of the range. Float,
/// without fused multiply-adds: every machine gives the same bits. Cost: O(log R + range).
void decode_vertices(const QuantizedView& poses, std::uint32_t key, VertexRange range,
                     std::span<Vec3f> out);

}  // namespace mdk
