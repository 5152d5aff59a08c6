// Sizes first, then what indexes by them.
#include "formats/pose_check.h"

#include <cmath>
#include <cstdint>
#include <span>

#include "formats/check_text.h"

namespace mdk {
namespace {

/// Lists of other kinds of poses than the model has.
std::string check_absent(const Model& m) {
  const PoseSource& poses = m.poses;
  if (poses.kind != PoseKind::kKeyPositions && !poses.key_positions.empty())
    return "key_positions: there, though poses are stored in another way";
  const RigView& rig = poses.rig;
  const bool has_rig = !rig.base_positions.empty() || !rig.first_weight.empty() ||
                       !rig.bone_weights.empty() || !rig.first_offset.empty() ||
                       !rig.morph_offsets.empty() || !rig.bone_maps.empty() ||
                       !rig.target_weights.empty();
  if (poses.kind != PoseKind::kRig && has_rig)
    return "base_positions: a rig is there, though poses are stored in another way";
  const QuantizedView& q = poses.quantized;
  const bool has_quantized = !q.error.empty() || !q.first_vertex.empty() ||
                             !q.rest_positions.empty() || !q.blocks.empty() || !q.words.empty();
  if (poses.kind != PoseKind::kQuantized && has_quantized)
    return "quantized_blocks: there, though poses are stored in another way";
  return {};
}

/// Whether `first` cuts a list of `size` into consecutive runs of at least `least` items.
std::string run_fault(const char* name, std::span<const std::uint32_t> first, std::uint64_t size,
                      std::uint32_t least) {
  const std::string where = std::string(name) + ": ";
  if (first.empty() || first.front() != 0 || first.back() != size)
    return where + "the runs do not cover their list";
  for (std::size_t i = 0; i + 1 < first.size(); ++i) {
    if (first[i + 1] < first[i] || first[i + 1] - first[i] < least)
      return where + "run " + number(i) + " ends too early";
  }
  return {};
}

std::string share_fault(const char* name, std::uint64_t count, std::uint64_t keys) {
  if (count % keys == 0) return {};
  return std::string(name) + ": " + number(count) + " of them are not as many for each of " +
         number(keys) + " keys";
}

std::string check_rig_sizes(const RigView& rig, std::uint64_t vertices, std::uint64_t keys) {
  const bool morphs = !rig.first_offset.empty();
  const std::string faults[] = {
      count_fault("base_positions", rig.base_positions.size(), vertices),
      count_fault("first_weight", rig.first_weight.size(), vertices + 1),
      count_fault("first_offset", rig.first_offset.size(), morphs ? vertices + 1 : 0),
      share_fault("bone_maps", rig.bone_maps.size(), keys),
      share_fault("target_weights", rig.target_weights.size(), keys),
      morphs ? "" : count_fault("morph_offsets", rig.morph_offsets.size(), 0),
  };
  for (const std::string& fault : faults) {
    if (!fault.empty()) return fault;
  }
  return {};
}

std::string check_rig_links(const RigView& rig, std::uint64_t keys) {
  if (std::string fault = run_fault("first_weight", rig.first_weight, rig.bone_weights.size(), 1);
      !fault.empty())
    return fault;
  const std::uint64_t bones = rig.bone_maps.size() / keys;
  for (std::size_t i = 0; i < rig.bone_weights.size(); ++i) {
    if (rig.bone_weights[i].bone >= bones)
      return "bone_weights: number " + number(i) + " names bone " +
             number(rig.bone_weights[i].bone) + " of " + number(bones);
  }
  if (rig.first_offset.empty()) return {};
  if (std::string fault = run_fault("first_offset", rig.first_offset, rig.morph_offsets.size(), 0);
      !fault.empty())
    return fault;
  const std::uint64_t targets = rig.target_weights.size() / keys;
  for (std::size_t i = 0; i < rig.morph_offsets.size(); ++i) {
    if (rig.morph_offsets[i].target >= targets)
      return "morph_offsets: number " + number(i) + " names target " +
             number(rig.morph_offsets[i].target) + " of " + number(targets);
  }
  return {};
}

bool is_number(float value) { return std::isfinite(value); }
bool is_number(const Vec3f& v) { return is_number(v.x) && is_number(v.y) && is_number(v.z); }
bool is_number(const BoneWeight& w) { return is_number(w.weight); }
bool is_number(const MorphOffset& m) { return is_number(m.offset); }
bool is_number(const Affine3f& map) { return is_finite(map); }

template <class T>
std::string number_fault(const char* name, std::span<const T> items) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (!is_number(items[i])) return std::string(name) + ": number " + number(i) + " is not finite";
  }
  return {};
}

std::string check_rig_numbers(const RigView& rig) {
  const std::string faults[] = {
      number_fault("base_positions", rig.base_positions),
      number_fault("bone_weights", rig.bone_weights),
      number_fault("morph_offsets", rig.morph_offsets),
      number_fault("bone_maps", rig.bone_maps),
      number_fault("target_weights", rig.target_weights),
  };
  for (const std::string& fault : faults) {
    if (!fault.empty()) return fault;
  }
  return {};
}

std::string check_rig(const Model& m) {
  const RigView& rig = m.poses.rig;
  const std::uint64_t keys = m.key_times.size();
  if (std::string fault = check_rig_sizes(rig, m.vertex_count, keys); !fault.empty()) return fault;
  if (std::string fault = check_rig_links(rig, keys); !fault.empty()) return fault;
  return check_rig_numbers(rig);
}

std::string check_quantization_error(const QuantizedView& q) {
  if (std::string fault = count_fault("quantization_error", q.error.size(), 1); !fault.empty())
    return fault;
  const bool sound = std::isfinite(q.error[0].bound) && q.error[0].largest >= 0 &&
                     q.error[0].largest <= q.error[0].bound;
  return sound ? "" : "quantization_error: the largest error is not within its bound";
}

std::string check_quantized_block(const QuantizedBlock& block, std::uint64_t first_bit,
                                  std::size_t i) {
  const std::string name = "quantized_blocks: block " + number(i);
  for (const std::uint8_t bits : block.bits) {
    if (bits > kMostCoordinateBits) return name + " has coordinates of more than 16 bits";
  }
  if (!is_number(block.step) || !is_number(block.world_from_local))
    return name + " has a number that is not finite";
  if (block.first_bit != first_bit) return name + " does not start where the last one ended";
  return {};
}

std::string check_quantized(const Model& m) {
  const QuantizedView& q = m.poses.quantized;
  if (std::string fault = check_quantization_error(q); !fault.empty()) return fault;
  if (std::string fault = run_fault("first_vertex", q.first_vertex, m.vertex_count, 1);
      !fault.empty())
    return fault;
  const std::uint64_t runs = q.first_vertex.size() - 1;
  for (const std::string& fault :
       {count_fault("rest_positions", q.rest_positions.size(), m.vertex_count),
        number_fault("rest_positions", q.rest_positions),
        count_fault("quantized_blocks", q.blocks.size(), runs * m.key_times.size())}) {
    if (!fault.empty()) return fault;
  }
  const std::uint64_t room = 32 * std::uint64_t{q.words.size()};
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < q.blocks.size(); ++i) {
    if (std::string fault = check_quantized_block(q.blocks[i], bits, i); !fault.empty())
      return fault;
    const std::uint64_t vertices = q.first_vertex[i % runs + 1] - q.first_vertex[i % runs];
    bits = (bits + vertices * q.blocks[i].bits_per_vertex() + 31) / 32 * 32;
    if (bits > room) break;
  }
  return count_fault("quantized_words", q.words.size(), bits / 32 + 1);
}

}  // namespace

std::string check_poses(const Model& m) {
  if (std::string fault = check_absent(m); !fault.empty()) return fault;
  switch (m.poses.kind) {
    case PoseKind::kKeyPositions:
      return count_fault("key_positions", m.poses.key_positions.size(),
                         std::uint64_t{m.vertex_count} * m.key_times.size());
    case PoseKind::kRig:
      return check_rig(m);
    case PoseKind::kQuantized:
      return check_quantized(m);
  }
  return "model: the kind of its poses is unknown";
}

}  // namespace mdk
