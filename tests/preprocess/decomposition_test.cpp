// The decomposition's own structures: what is sound passes, each broken promise is found.
#include "preprocess/decomposition.h"

#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "preprocess/boxes/segments.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

/// A decomposition of a sheet into three stripes, without motion.
struct Sound {
  PoseSequence sequence = wild_motion(60, 8);
  Decomposition parts;

  Sound() {
    std::vector<std::uint32_t> stripes(sequence.triangles.size());
    for (std::size_t t = 0; t < stripes.size(); ++t)
      stripes[t] = static_cast<std::uint32_t>(3 * t / stripes.size());
    static_cast<Assignment&>(parts.growth) = make_assignment(stripes);
    parts.members = make_cluster_members(sequence.triangles, parts.growth, sequence.vertex_count);
    parts.maps.local_from_world.resize(3 * std::size_t{sequence.key_count()});
    parts.segments = smallest_segments(sequence.clips);
  }
};

TEST(Decomposition, OfThreeStripesIsSound) {
  const Sound sound;
  EXPECT_NO_THROW(validate(sound.parts, sound.sequence));
}

TEST(Decomposition, EveryBrokenPromiseIsFound) {
  const std::function<void(Decomposition&)> breaks[] = {
      [](Decomposition& d) { d.growth.cluster_of_triangle.pop_back(); },
      [](Decomposition& d) { d.growth.cluster_of_triangle[3] = 3; },
      [](Decomposition& d) { d.growth.cluster_count = 4; },
      [](Decomposition& d) { d.growth.cluster_of_triangle[0] = 1; },
      [](Decomposition& d) { d.growth.rest_key = 8; },
      [](Decomposition& d) { d.members.triangles[1] = d.members.triangles[0]; },
      [](Decomposition& d) { d.members.triangle_begin[1] = 0; },
      [](Decomposition& d) { d.members.triangle_begin.back() -= 1; },
      [](Decomposition& d) { d.members.vertex_begin[1] += 1; },
      [](Decomposition& d) { d.members.uses[2] += 1; },
      [](Decomposition& d) { d.members.vertices[1] = d.members.vertices[0]; },
      [](Decomposition& d) { d.members.corner_slots[0] = d.members.corner_slots.back(); },
      [](Decomposition& d) { d.maps.local_from_world.pop_back(); },
      [](Decomposition& d) { d.bones.resize(2); },
      [](Decomposition& d) { d.pose_space_boxes.resize(1); },
      [](Decomposition& d) { d.segments.pop_back(); },
      [](Decomposition& d) { d.segments.push_back(d.segments.front()); },
      [](Decomposition& d) { std::swap(d.segments[0].first_key, d.segments[0].last_key); },
  };
  for (std::size_t i = 0; i < std::size(breaks); ++i) {
    Sound broken;
    breaks[i](broken.parts);
    EXPECT_THROW(validate(broken.parts, broken.sequence), std::logic_error) << "break " << i;
  }
}

TEST(Decomposition, AssignmentsDropClustersWithoutTriangles) {
  const Assignment assignment = make_assignment({7, 2, 2, 9, 7});
  EXPECT_EQ(assignment.cluster_of_triangle, (std::vector<std::uint32_t>{1, 0, 0, 2, 1}));
  EXPECT_EQ(assignment.cluster_count, 3u);
  EXPECT_NO_THROW(validate(assignment, 5));
}

}  // namespace
}  // namespace mdk
