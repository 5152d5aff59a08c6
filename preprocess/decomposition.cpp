#include "preprocess/decomposition.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace mdk {
namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(std::string("decomposition: ") + what);
}

/// Starts of compressed lists: rising from 0 to `size`.
void require_starts(std::span<const std::uint32_t> begin, std::size_t size, const char* what) {
  require(!begin.empty() && begin.front() == 0 && begin.back() == size &&
              std::is_sorted(begin.begin(), begin.end()),
          what);
}

}  // namespace

Assignment make_assignment(std::vector<std::uint32_t> cluster_of_triangle) {
  Assignment result{std::move(cluster_of_triangle), 0};
  std::vector<std::uint32_t>& of_triangle = result.cluster_of_triangle;
  const auto largest = std::max_element(of_triangle.begin(), of_triangle.end());
  std::vector<std::uint32_t> number(largest == of_triangle.end() ? 0 : *largest + 1, 0);
  for (const std::uint32_t c : of_triangle) number[c] = 1;
  for (std::uint32_t& n : number) n = n != 0 ? result.cluster_count++ : 0;
  for (std::uint32_t& c : of_triangle) c = number[c];
  return result;
}

Assignment one_cluster(std::size_t triangle_count) {
  return {std::vector<std::uint32_t>(triangle_count, 0), 1};
}

const char* stop_reason_id(StopReason reason) {
  switch (reason) {
    case StopReason::kCost:
      return "cost";
    case StopReason::kPercent:
      return "percent";
    case StopReason::kCount:
      return "count";
    case StopReason::kLimit:
      return "limit";
    case StopReason::kBones:
      return "bones";
    case StopReason::kNone:
      break;
  }
  return "none";
}

ClusterMembers make_cluster_members(std::span<const Triangle> triangles,
                                    const Assignment& assignment, std::uint32_t vertex_count) {
  const std::uint32_t cluster_count = assignment.cluster_count;
  ClusterMembers members;
  members.triangle_begin.assign(cluster_count + 1, 0);
  for (const std::uint32_t c : assignment.cluster_of_triangle) ++members.triangle_begin[c + 1];
  for (std::uint32_t c = 0; c < cluster_count; ++c)
    members.triangle_begin[c + 1] += members.triangle_begin[c];

  members.triangles.resize(triangles.size());
  std::vector<std::uint32_t> next(members.triangle_begin.begin(), members.triangle_begin.end() - 1);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    members.triangles[next[assignment.cluster_of_triangle[t]]++] = static_cast<std::uint32_t>(t);

  members.vertex_begin.assign(1, 0);
  members.corner_slots.reserve(3 * triangles.size());
  std::vector<std::uint32_t> slot_of_vertex(vertex_count, 0);
  for (std::uint32_t c = 0; c < cluster_count; ++c) {
    const std::uint32_t first_slot = members.vertex_begin.back();
    for (const std::uint32_t t : members.triangles_of(c)) {
      for (const std::uint32_t v : triangles[t].v) {
        // A slot left by an earlier cluster lies below this cluster's first one or names another
        // vertex.
        std::uint32_t slot = slot_of_vertex[v];
        if (slot < first_slot || slot >= members.vertices.size() || members.vertices[slot] != v) {
          slot = static_cast<std::uint32_t>(members.vertices.size());
          slot_of_vertex[v] = slot;
          members.vertices.push_back(v);
          members.uses.push_back(0);
        }
        ++members.uses[slot];
        members.corner_slots.push_back(slot);
      }
    }
    members.vertex_begin.push_back(static_cast<std::uint32_t>(members.vertices.size()));
  }
  return members;
}

std::vector<std::uint32_t> cluster_order(const ClusterMembers& members,
                                         std::uint32_t vertex_count) {
  std::vector<std::uint32_t> order;
  std::vector<char> seen(vertex_count, 0);
  for (const std::uint32_t v : members.vertices) {
    if (!seen[v]) order.push_back(v);
    seen[v] = 1;
  }
  return order;
}

void validate(const Assignment& assignment, std::size_t triangle_count) {
  require(assignment.cluster_of_triangle.size() == triangle_count,
          "the assignment has another number of triangles than the mesh");
  std::vector<char> in_use(assignment.cluster_count, 0);
  for (const std::uint32_t c : assignment.cluster_of_triangle) {
    require(c < assignment.cluster_count, "a triangle is in a cluster that does not exist");
    in_use[c] = 1;
  }
  require(std::count(in_use.begin(), in_use.end(), 0) == 0, "a cluster has no triangle");
}

void validate(const ClusterMembers& members, std::span<const Triangle> triangles) {
  require_starts(members.triangle_begin, members.triangles.size(),
                 "the clusters' lists of triangles do not follow each other");
  require_starts(members.vertex_begin, members.vertices.size(),
                 "the clusters' lists of vertices do not follow each other");
  require(members.vertex_begin.size() == members.triangle_begin.size() &&
              members.uses.size() == members.vertices.size() &&
              members.corner_slots.size() == 3 * members.triangles.size(),
          "the members' lists have different lengths");
  std::vector<char> placed(triangles.size(), 0);
  for (const std::uint32_t t : members.triangles) {
    require(t < triangles.size() && placed[t] == 0,
            "a triangle does not exist or is in two clusters");
    placed[t] = 1;
  }
  require(members.triangles.size() == triangles.size(), "a triangle is in no cluster");

  std::vector<std::uint32_t> uses(members.vertices.size(), 0);
  for (std::size_t c = 0; c < members.cluster_count(); ++c) {
    const std::span<const std::uint32_t> own = members.triangles_of(c);
    require(!own.empty(), "a cluster has no triangle");
    for (std::size_t i = 0; i < 3 * own.size(); ++i) {
      const std::uint32_t slot = members.corner_slots_of(c)[i];
      require(slot >= members.vertex_begin[c] && slot < members.vertex_begin[c + 1],
              "a corner is not in its own cluster's list of vertices");
      require(members.vertices[slot] == triangles[own[i / 3]].v[i % 3],
              "a corner has another vertex than its triangle");
      ++uses[slot];
    }
    const std::span<const std::uint32_t> vertices = members.vertices_of(c);
    std::vector<std::uint32_t> sorted(vertices.begin(), vertices.end());
    std::sort(sorted.begin(), sorted.end());
    require(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end(),
            "a cluster lists a vertex twice");
  }
  require(uses == members.uses, "a vertex has another number of uses than corners use it");
}

void validate(std::span<const Segment> segments, std::span<const Clip> clips) {
  const auto holders = [&](std::uint32_t first, std::uint32_t last) {
    return std::count_if(segments.begin(), segments.end(), [&](const Segment& s) {
      return s.first_key <= first && last <= s.last_key;
    });
  };
  for (const Segment& s : segments) require(s.first_key <= s.last_key, "a segment is backwards");
  for (const Clip& clip : clips) {
    if (clip.key_count == 1)
      require(holders(clip.first_key, clip.first_key) == 1,
              "a clip of one key does not lie in exactly one segment");
    for (std::uint32_t key = clip.first_key + 1; key < clip.first_key + clip.key_count; ++key)
      require(holders(key - 1, key) == 1,
              "an interval between keys does not lie in exactly one segment");
  }
}

void validate(const Decomposition& decomposition, const PoseSequence& sequence) {
  const ClusterMembers& members = decomposition.members;
  const std::size_t clusters = members.cluster_count(), triangles = sequence.triangles.size();
  validate(decomposition.growth, triangles);
  validate(members, sequence.triangles);
  for (std::size_t c = 0; c < clusters; ++c)
    for (const std::uint32_t t : members.triangles_of(c))
      require(decomposition.growth.cluster_of_triangle[t] == c,
              "a triangle is listed by another cluster than it is assigned to");
  require(decomposition.growth.rest_key < sequence.key_count(), "the rest pose does not exist");
  require(decomposition.maps.local_from_world.size() == clusters * sequence.key_count(),
          "there is not one map for each cluster and key");
  require(decomposition.bones.empty() || decomposition.bones.size() == clusters,
          "there is not one bone for each cluster");
  require(
      decomposition.pose_space_boxes.empty() || decomposition.pose_space_boxes.size() == triangles,
      "there is not one pose space box for each triangle");
  validate(decomposition.segments, sequence.clips);
}

}  // namespace mdk
