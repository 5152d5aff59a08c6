#include "common/motion/quantized_poses.h"

#include <algorithm>

namespace mdk {
namespace {

/// `count` bits, at most 32, from bit `at` on. Of no bits there may be no word.
std::uint32_t read_bits(std::span<const std::uint32_t> words, std::uint64_t at,
                        std::uint32_t count) {
  if (count == 0) return 0;
  const std::uint64_t two = words[at / 32] | std::uint64_t{words[at / 32 + 1]} << 32;
  return static_cast<std::uint32_t>((two >> (at % 32)) & ((std::uint64_t{1} << count) - 1));
}

/// `range` lies in the run that starts at `first`.
void decode_run(const QuantizedView& poses, const QuantizedBlock& block, std::uint32_t first,
                VertexRange range, Vec3f* out) {
  const std::uint32_t width = block.bits_per_vertex();
  std::uint64_t at = block.first_bit + std::uint64_t{range.begin - first} * width;
  for (std::uint32_t v = range.begin; v < range.end; ++v) {
    Vec3f local = poses.rest_positions[v];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::uint32_t q = read_bits(poses.words, at, block.bits[axis]);
      local[axis] += block.step[axis] * static_cast<float>(q);
      at += block.bits[axis];
    }
    *out++ = block.world_from_local.point(local);
  }
}

}  // namespace

void decode_vertices(const QuantizedView& poses, std::uint32_t key, VertexRange range,
                     std::span<Vec3f> out) {
  const std::size_t runs = poses.first_vertex.size() - 1;
  const auto after = std::ranges::upper_bound(poses.first_vertex, range.begin);
  auto r = static_cast<std::size_t>(after - poses.first_vertex.begin()) - 1;
  for (; r < runs && poses.first_vertex[r] < range.end; ++r) {
    const std::uint32_t first = poses.first_vertex[r];
    const VertexRange part{std::max(first, range.begin),
                           std::min(poses.first_vertex[r + 1], range.end)};
    decode_run(poses, poses.blocks[key * runs + r], first, part, &out[part.begin - range.begin]);
  }
}

}  // namespace mdk
