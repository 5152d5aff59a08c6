// Positions lie key by key, so paths of vertices are compared key by key over a run of vertices: a
// vertex's own path would touch one cache line per key.
#include "common/motion/pose_sequence.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "common/base/parallel.h"

namespace mdk {
namespace {

constexpr std::uint32_t kUnused = 0xffffffffu;
constexpr std::size_t kKeysPerChunk = 2;
constexpr std::uint32_t kMaxTextureSide = 1u << 24;

void require(bool holds, const std::string& sentence) {
  if (!holds) throw std::logic_error("pose sequence: " + sentence);
}

bool is_wrap(TextureWrap wrap) {
  return wrap == TextureWrap::kRepeat || wrap == TextureWrap::kClamp ||
         wrap == TextureWrap::kMirror;
}

std::string material_fault(const AppearanceLists<ConstSpan>& look) {
  for (std::size_t i = 0; i < look.materials.size(); ++i) {
    const Material& material = look.materials[i];
    const std::string name = "materials: material " + std::to_string(i);
    for (const float channel : material.base_color) {
      if (!(channel >= 0 && channel <= 1)) return name + " has a colour outside [0, 1]";
    }
    if (material.texture != kNoTexture && material.texture >= look.textures.size()) {
      return name + " names texture " + std::to_string(material.texture) + " of " +
             std::to_string(look.textures.size());
    }
    if ((material.flags & ~std::uint32_t{kMaterialKnownFlags}) != 0) {
      return name + " has unknown flags";
    }
    if (!is_wrap(material.wrap_u) || !is_wrap(material.wrap_v))
      return name + " has an unknown wrap";
  }
  for (std::size_t t = 0; t < look.triangle_materials.size(); ++t) {
    if (look.triangle_materials[t] >= look.materials.size()) {
      return "triangle_materials: triangle " + std::to_string(t) + " names material " +
             std::to_string(look.triangle_materials[t]) + " of " +
             std::to_string(look.materials.size());
    }
  }
  return {};
}

std::string texture_fault(const AppearanceLists<ConstSpan>& look) {
  for (std::size_t i = 0; i < look.textures.size(); ++i) {
    const Texture& texture = look.textures[i];
    const std::string name = "textures: texture " + std::to_string(i);
    if (texture.width == 0 || texture.width > kMaxTextureSide || texture.height == 0 ||
        texture.height > kMaxTextureSide) {
      return name + " has an impossible size";
    }
    const std::uint64_t texels = std::uint64_t{texture.width} * texture.height;
    if (texels > look.texels.size() || texture.first_texel > look.texels.size() - texels) {
      return name + " reaches past the last texel";
    }
  }
  return {};
}

/// Few enough that all threads have some, many enough that what is read of each key is a good
/// stretch: keys may stand in a file that does not fit into memory.
std::size_t vertices_per_chunk(std::size_t vertices) {
  constexpr std::size_t kChunks = 16, kMin = 1024, kMax = std::size_t{1} << 16;
  return std::clamp(vertices / kChunks, kMin, kMax);
}

std::uint64_t mixed(std::uint64_t hash, float value) {
  // Adding 0 turns -0 into 0 and changes nothing else.
  hash = (hash ^ std::bit_cast<std::uint32_t>(value + 0.0f)) * 0x9fb21c651e98df25u;
  return hash ^ (hash >> 32);
}

/// Per undecided vertex the lowest undecided vertex with its hash.
std::vector<std::uint32_t> lowest_with_hash(std::span<const std::uint32_t> undecided,
                                            std::span<const std::uint64_t> hashes) {
  std::vector<std::uint32_t> order(undecided.begin(), undecided.end());
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return hashes[a] != hashes[b] ? hashes[a] < hashes[b] : a < b;
  });
  std::vector<std::uint32_t> candidates;
  for (std::uint32_t v : undecided) {
    const auto first =
        std::ranges::lower_bound(order, hashes[v], {}, [&](std::uint32_t u) { return hashes[u]; });
    candidates.push_back(*first);
  }
  return candidates;
}

/// Per undecided vertex whether its group or path differs from its candidate's.
std::vector<char> differing(const PoseSequence& sequence, std::span<const std::uint64_t> groups,
                            std::span<const std::uint32_t> undecided,
                            std::span<const std::uint32_t> candidates) {
  std::vector<char> differs(undecided.size(), 0);
  if (!groups.empty())
    for (std::size_t i = 0; i < undecided.size(); ++i)
      differs[i] = groups[candidates[i]] != groups[undecided[i]];
  parallel_chunks(
      undecided.size(), vertices_per_chunk(undecided.size()),
      [&](std::size_t begin, std::size_t end) {
        for (std::uint32_t key = 0; key < sequence.key_count(); ++key) {
          const std::span<const Vec3f> pose = sequence.pose(key);
          for (std::size_t i = begin; i < end; ++i)
            if (candidates[i] != undecided[i] && !(pose[candidates[i]] == pose[undecided[i]]))
              differs[i] = 1;
        }
      });
  return differs;
}

/// One number per vertex: equal for equal paths, almost surely different for others.
std::vector<std::uint64_t> hash_paths(const PoseSequence& sequence) {
  std::vector<std::uint64_t> hashes(sequence.vertex_count, 0x2545f4914f6cdd1du);
  parallel_chunks(hashes.size(), vertices_per_chunk(hashes.size()),
                  [&](std::size_t begin, std::size_t end) {
                    for (std::uint32_t key = 0; key < sequence.key_count(); ++key) {
                      const std::span<const Vec3f> pose = sequence.pose(key);
                      for (std::size_t i = begin; i < end; ++i)
                        hashes[i] = mixed(mixed(mixed(hashes[i], pose[i].x), pose[i].y), pose[i].z);
                    }
                  });
  return hashes;
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
  std::vector<char> used(sequence.vertex_count, 0);
  for (Triangle& triangle : sequence.triangles) {
    for (std::uint32_t& v : triangle.v) {
      v = lowest[v];
      if (!used[v]) kept.push_back(v);
      used[v] = 1;
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

std::string clip_fault(std::span<const Clip> clips, std::span<const double> key_times) {
  std::uint64_t next_key = 0;
  for (std::size_t i = 0; i < clips.size(); ++i) {
    const Clip& clip = clips[i];
    const std::string name = "clips: clip " + std::to_string(i);
    if (clip.first_key != next_key || clip.key_count == 0)
      return name + " does not start where the last one ended, or is empty";
    next_key += clip.key_count;
    if (next_key > key_times.size()) return name + " reaches past the last key";
    const auto times = key_times.subspan(clip.first_key, clip.key_count);
    for (std::size_t k = 0; k < times.size(); ++k) {
      const bool in_order = k == 0 ? times[k] >= 0 : times[k] > times[k - 1];
      if (!std::isfinite(times[k]) || !in_order)
        return "key_times: key " + std::to_string(clip.first_key + k) +
               " has a time that is not finite, negative, or not after the one before";
    }
  }
  return next_key == key_times.size() ? "" : "clips: they do not cover every key";
}

std::string triangle_fault(std::span<const Triangle> triangles, std::uint32_t vertex_count) {
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const std::uint32_t vertex : triangles[t].v)
      if (vertex >= vertex_count)
        return "triangles: triangle " + std::to_string(t) + " names vertex " +
               std::to_string(vertex) + " of " + std::to_string(vertex_count);
  return {};
}

std::string appearance_fault(const AppearanceLists<ConstSpan>& look, std::uint64_t triangles) {
  ArrayCounts counts;
  counts.set(Count::kTriangles, triangles);
  counts.set(Count::kCorners, 3 * triangles);
  std::string fault;
  Appearance::for_each_array(
      [&](const ModelArray& row, const auto& array) {
        if (fault.empty()) fault = count_fault(row, array.size(), counts);
      },
      look);
  if (fault.empty()) fault = material_fault(look);
  return fault.empty() ? texture_fault(look) : fault;
}

void check_consistency(const PoseSequence& sequence) {
  const auto require_none = [](const std::string& fault) { require(fault.empty(), fault); };
  require(!sequence.clips.empty(), "has no clip");
  require_none(clip_fault(sequence.clips, sequence.key_times));
  require(sequence.positions.size() == sequence.key_times.size() * sequence.vertex_count,
          "does not have one position per vertex and key");
  require_none(triangle_fault(sequence.triangles, sequence.vertex_count));
  require(sequence.triangle_meshes.empty() ||
              sequence.triangle_meshes.size() == sequence.triangles.size(),
          "tells the mesh of some triangles only");
  require_none(appearance_fault(sequence.appearance.view(), sequence.triangles.size()));
  if (sequence.skeleton)
    require(sequence.rig && sequence.rig->bone_maps.size() ==
                                sequence.key_times.size() * sequence.skeleton->bones.size(),
            "has a skeleton with other bones than its rig");
}

std::vector<std::uint32_t> lowest_equal_paths(const PoseSequence& sequence,
                                              std::span<const std::uint64_t> groups,
                                              std::span<const std::uint64_t> hashes) {
  std::vector<std::uint32_t> result(sequence.vertex_count);
  std::vector<std::uint32_t> undecided(sequence.vertex_count);
  std::iota(undecided.begin(), undecided.end(), 0u);
  // A round settles the lowest vertex of every hash and all that move like it; vertices whose hash
  // collided with another path's go on among themselves.
  while (!undecided.empty()) {
    const std::vector<std::uint32_t> candidates = lowest_with_hash(undecided, hashes);
    const std::vector<char> differs = differing(sequence, groups, undecided, candidates);
    std::vector<std::uint32_t> rest;
    for (std::size_t i = 0; i < undecided.size(); ++i) {
      if (differs[i])
        rest.push_back(undecided[i]);
      else
        result[undecided[i]] = candidates[i];
    }
    undecided = std::move(rest);
  }
  return result;
}

}  // namespace mdk
