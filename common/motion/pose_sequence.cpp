#include "common/motion/pose_sequence.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/parallel.h"
#include "common/motion/vertex_paths.h"

namespace mdk {
namespace {

constexpr std::uint32_t kUnused = 0xffffffffu;
constexpr std::size_t kKeysPerChunk = 2;

void require(bool holds, const char* sentence) {
  if (!holds) throw std::logic_error(std::string("pose sequence: ") + sentence);
}

void check_clips(const PoseSequence& s) {
  require(!s.clips.empty(), "has no clip");
  std::size_t next = 0;
  for (const Clip& clip : s.clips) {
    require(clip.key_count > 0, "has a clip without keys");
    require(clip.first_key == next, "has clips that do not follow one another");
    next += clip.key_count;
    require(next <= s.key_times.size(), "has clips with more keys than there are times");
    require(s.key_times[clip.first_key] >= 0, "has a clip that starts before zero");
    for (std::size_t k = clip.first_key + std::size_t{1}; k < next; ++k)
      require(s.key_times[k] > s.key_times[k - 1], "has times that do not rise within a clip");
  }
  require(next == s.key_times.size(), "has keys outside its clips");
}

void check_appearance(const PoseSequence& s) {
  const Appearance& a = s.appearance;
  const std::size_t triangles = s.triangles.size();
  require(!a.materials.empty(), "has no material");
  require(a.triangle_materials.size() == triangles, "does not give each triangle a material");
  for (std::uint32_t m : a.triangle_materials)
    require(m < a.materials.size(), "refers to a material it does not have");
  require(a.corner_texcoords.empty() || a.corner_texcoords.size() == 3 * triangles,
          "has texture coordinates for some corners only");
  require(a.corner_colors.empty() || a.corner_colors.size() == 3 * triangles,
          "has colours for some corners only");
  for (const Material& m : a.materials)
    require(m.texture == kNoTexture || m.texture < a.textures.size(),
            "refers to a texture it does not have");
  for (const Texture& t : a.textures) {
    const std::uint64_t texels = std::uint64_t{t.width} * t.height;
    require(
        texels > 0 && t.first_texel <= a.texels.size() && texels <= a.texels.size() - t.first_texel,
        "has a texture outside its texels");
  }
}

void check_meshes(const PoseSequence& s) {
  require(s.triangle_meshes.empty() || s.triangle_meshes.size() == s.triangles.size(),
          "tells the mesh of some triangles only");
}

/// The lowest vertex that moves alike and is smoothed alike, for each vertex.
std::vector<std::uint32_t> lowest_alike(const PoseSequence& sequence,
                                        std::span<const std::uint64_t> groups) {
  if (sequence.rig) return lowest_alike_vertices(*sequence.rig, groups);
  std::vector<std::uint64_t> hashes = hash_paths(sequence);
  for (std::size_t i = 0; i < groups.size(); ++i) hashes[i] ^= groups[i] * 0x9e3779b97f4a7c15u;
  return lowest_equal_paths(sequence, groups, hashes);
}

/// Keeps the positions of `kept` in every pose. A pose shrinks towards the front of the list, never
/// past poses that are still to be read; the room behind stays, since giving it back would need
/// both at once.
void select_rows(PoseSequence& sequence, std::span<const std::uint32_t> kept) {
  std::vector<Vec3f> row(kept.size());
  for (std::uint32_t key = 0; key < sequence.key_count(); ++key) {
    const std::span<const Vec3f> pose = std::as_const(sequence).pose(key);
    for (std::size_t i = 0; i < kept.size(); ++i) row[i] = pose[kept[i]];
    std::ranges::copy(row,
                      sequence.positions.begin() + static_cast<std::ptrdiff_t>(key * kept.size()));
  }
  sequence.positions.resize(sequence.key_times.size() * kept.size());
}

}  // namespace

void weld_vertices(PoseSequence& sequence, std::span<const std::uint64_t> smoothing_groups) {
  require(smoothing_groups.empty() || smoothing_groups.size() == sequence.vertex_count,
          "does not give each vertex a smoothing group");
  const std::vector<std::uint32_t> lowest = lowest_alike(sequence, smoothing_groups);
  std::vector<std::uint32_t> kept;  // in the order of first use
  std::vector<char> met(sequence.vertex_count, 0);
  for (Triangle& triangle : sequence.triangles) {
    for (std::uint32_t& v : triangle.v) {
      v = lowest[v];
      if (!met[v]) kept.push_back(v);
      met[v] = 1;
    }
  }
  select_vertices(sequence, kept);
}

void select_vertices(PoseSequence& sequence, std::span<const std::uint32_t> kept) {
  if (sequence.rig) sequence.rig = select_vertices(*sequence.rig, kept);
  if (!sequence.positions.empty()) select_rows(sequence, kept);
  std::vector<std::uint32_t> new_number(sequence.vertex_count, kUnused);
  for (std::size_t i = 0; i < kept.size(); ++i) new_number[kept[i]] = static_cast<std::uint32_t>(i);
  for (Triangle& triangle : sequence.triangles)
    for (std::uint32_t& v : triangle.v) v = new_number[v];
  sequence.vertex_count = static_cast<std::uint32_t>(kept.size());
}

void decode_positions(PoseSequence& sequence) {
  const RigView rig = sequence.rig->view();
  sequence.positions.resize(sequence.key_times.size() * sequence.vertex_count);
  parallel_chunks(sequence.key_times.size(), kKeysPerChunk,
                  [&](std::size_t begin, std::size_t end) {
                    for (std::size_t k = begin; k < end; ++k) {
                      const auto key = static_cast<std::uint32_t>(k);
                      pose_vertices(rig, rig_pose(rig, key, sequence.key_count()),
                                    {0, sequence.vertex_count}, sequence.pose(key));
                    }
                  });
}

void check_consistency(const PoseSequence& sequence) {
  check_clips(sequence);
  require(sequence.positions.size() == sequence.key_times.size() * sequence.vertex_count,
          "does not have one position per vertex and key");
  for (const Triangle& t : sequence.triangles)
    for (std::uint32_t v : t.v)
      require(v < sequence.vertex_count, "has a triangle with a vertex it does not have");
  check_meshes(sequence);
  check_appearance(sequence);
  if (sequence.skeleton)
    require(sequence.rig && sequence.rig->bone_maps.size() ==
                                sequence.key_times.size() * sequence.skeleton->bones.size(),
            "has a skeleton with other bones than its rig");
}

}  // namespace mdk
