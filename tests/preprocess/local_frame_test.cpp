#include "preprocess/local_frame.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "preprocess/cluster_fit.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

/// A flat sheet, tilted against the axes, at rest for a few keys.
PoseSequence tilted_sheet() {
  Mesh mesh = curved_sheet(6);
  const Affine3d tilt = rigid_motion({1, 1, 0.3}, 0.8, {5, 0, 0});
  for (Vec3d& v : mesh.vertices) v = tilt.point({v.x, 0.4 * v.y, 0});
  return make_sequence(mesh, 3, [&](std::uint32_t, std::uint32_t i) { return mesh.vertices[i]; });
}

struct Framed {
  LocalFrames frames;
  double plain_area = 0;  ///< of the boxes in the axes as they are
};

Framed frame(const PoseSequence& sequence) {
  std::vector<std::uint32_t> keys(sequence.key_count());
  std::iota(keys.begin(), keys.end(), 0u);
  const PoseTable table = make_pose_table(sequence, keys, pose_unit(sequence));
  const ClusterMembers members = make_cluster_members(
      sequence.triangles, std::vector<std::uint32_t>(sequence.triangles.size(), 0), 1,
      sequence.vertex_count);
  const ClusterMaps maps = fit_clusters(table, members, 0);
  Framed result{choose_local_frames(table, members, maps.maps, {}), 0};
  FaceSums plain;
  for (const Triangle& t : sequence.triangles) {
    Aabbd box;
    for (std::uint32_t row = 0; row < table.row_count(); ++row)
      for (const std::uint32_t v : t.v) box.extend(maps.maps[row].point(table.position(row, v)));
    plain.add(box);
  }
  result.plain_area = plain.area(result.frames.clusters[0].weights);
  return result;
}

TEST(LocalFrame, AlignsATiltedSheetSoThatItsBoxesAreFlat) {
  const Framed framed = frame(tilted_sheet());
  const ClusterWork& work = framed.frames.clusters[0];
  EXPECT_LT(work.fuzzy_boxes.area(work.weights), 0.8 * framed.plain_area);
}

TEST(LocalFrame, IsAProperRotationAndNeverWorseThanNone) {
  for (std::uint32_t seed = 30; seed < 40; ++seed) {
    const Framed framed = frame(wild_motion(seed, 6));
    const Affine3d& basis = framed.frames.local_from_rest[0];
    EXPECT_NEAR(basis.determinant(), 1, 1e-9);
    EXPECT_NEAR(length(basis.column(0)), 1, 1e-9);
    EXPECT_NEAR(dot(basis.column(0), basis.column(1)), 0, 1e-9);
    const ClusterWork& work = framed.frames.clusters[0];
    EXPECT_LE(work.fuzzy_boxes.area(work.weights), framed.plain_area * (1 + 1e-9));
  }
}

TEST(LocalFrame, TheOnlyClusterIsMetByEveryRayThatMeetsTheModel) {
  EXPECT_NEAR(frame(wild_motion(41, 5)).frames.clusters[0].hit_probability, 1, 1e-9);
}

}  // namespace
}  // namespace mdk
