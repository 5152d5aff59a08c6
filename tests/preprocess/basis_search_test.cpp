#include "preprocess/basis_search.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

#include "preprocess/local_frame.h"
#include "tests/preprocess/moving_meshes.h"

namespace mdk {
namespace {

/// One cluster of a whole sequence, with the maps that leave everything where it is.
struct Whole {
  ClusterPoints points;
  std::vector<Affine3d> maps;
  std::vector<double> model_areas;

  explicit Whole(const PoseSequence& sequence) {
    std::vector<std::uint32_t> keys(sequence.key_count());
    std::iota(keys.begin(), keys.end(), 0u);
    const PoseTable table = make_pose_table(sequence, keys, pose_unit(sequence));
    const std::vector<std::uint32_t> one(sequence.triangles.size(), 0);
    points = gather_points(table,
                           make_cluster_members(sequence.triangles, one, 1, table.vertex_count), 0);
    maps.resize(points.row_count);
    model_areas = model_box_areas(table);
  }
  double area(std::span<const Affine3d> of) const {
    return fuzzy_area(points, of, model_areas, {});
  }
};

TEST(BasisSearch, FindsTheBasisInWhichASheetIsFlat) {
  Mesh mesh = curved_sheet(6);
  const Affine3d tilt = rigid_motion({1, -2, 0.4}, 0.9, {});
  for (Vec3d& v : mesh.vertices) v = tilt.point({v.x, v.y, 0});
  const Whole sheet(
      make_sequence(mesh, 3, [&](std::uint32_t, std::uint32_t i) { return mesh.vertices[i]; }));
  const double before = sheet.area(sheet.maps);
  const double after =
      sheet.area(turned_to_small_boxes(sheet.points, sheet.maps, sheet.model_areas, {}));
  EXPECT_LT(after, 0.62 * before);  // half is flat, and in the axes of the quads
}

TEST(BasisSearch, TurnsAndNeverMakesBoxesLarger) {
  for (std::uint32_t seed = 310; seed < 316; ++seed) {
    const Whole whole(wild_motion(seed, 45));  // more keys than are searched on
    const std::vector<Affine3d> turned =
        turned_to_small_boxes(whole.points, whole.maps, whole.model_areas, {});
    EXPECT_LE(whole.area(turned), whole.area(whole.maps)) << "seed " << seed;
    for (const Affine3d& map : turned) {
      EXPECT_NEAR(map.determinant(), 1, 1e-9);
      EXPECT_NEAR(dot(map.column(0), map.column(1)), 0, 1e-9);
      EXPECT_NEAR(length(map.column(2)), 1, 1e-9);
    }
  }
}

}  // namespace
}  // namespace mdk
