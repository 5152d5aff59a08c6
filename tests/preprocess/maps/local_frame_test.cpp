#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "preprocess/maps/affine_fit.h"
#include "preprocess/maps/cluster_maps.h"
#include "tests/preprocess/moving_meshes.h"
#include "tests/preprocess/whole_sequence.h"

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
  const PoseTable table = whole_table(sequence);
  const ClusterMembers members = whole_members(sequence);
  const std::vector<Affine3d> maps = fit_clusters(table, members, 0);
  Framed result{choose_local_frames(table, members, maps), 0};
  FaceSums plain;
  for (const Triangle& t : sequence.triangles) {
    Aabbd box;
    for (std::uint32_t row = 0; row < table.row_count(); ++row)
      for (const std::uint32_t v : t.v) box.extend(maps[row].point(table.position(row, v)));
    plain.add(box);
  }
  result.plain_area = plain.area(result.frames.clusters[0].weights);
  return result;
}

TEST(LocalFrame, AlignsATiltedSheetSoThatItsBoxesAreFlat) {
  const Framed framed = frame(tilted_sheet());
  const ClusterWork& work = framed.frames.clusters[0];
  EXPECT_LT(work.area(), 0.8 * framed.plain_area);
}

TEST(LocalFrame, IsAProperRotationAndNeverWorseThanNone) {
  for (std::uint32_t seed = 30; seed < 40; ++seed) {
    const Framed framed = frame(wild_motion(seed, 6));
    const Affine3d& basis = framed.frames.local_from_rest[0];
    EXPECT_NEAR(basis.determinant(), 1, 1e-9);
    EXPECT_NEAR(length(basis.column(0)), 1, 1e-9);
    EXPECT_NEAR(dot(basis.column(0), basis.column(1)), 0, 1e-9);
    const ClusterWork& work = framed.frames.clusters[0];
    EXPECT_LE(work.area(), framed.plain_area * (1 + 1e-9));
  }
}

TEST(LocalFrame, TheOnlyClusterIsEnteredByEveryRayThatHitsTheModel) {
  EXPECT_NEAR(frame(wild_motion(41, 5)).frames.clusters[0].hit_probability, 1, 1e-9);
}

/// One cluster of a whole sequence, with the maps that leave everything where it is.
struct Whole {
  ClusterPoints points;
  std::vector<Affine3d> maps;
  std::vector<double> model_areas;

  explicit Whole(const PoseSequence& sequence) {
    const PoseTable table = whole_table(sequence);
    points = gather_points(table, whole_members(sequence), 0);
    maps.resize(points.row_count);
    model_areas = row_box_areas(table);
  }
  double area(std::span<const Affine3d> of) const { return fuzzy_area(points, of, model_areas); }
};

TEST(BasisSearch, FindsTheBasisInWhichASheetIsFlat) {
  Mesh mesh = curved_sheet(6);
  const Affine3d tilt = rigid_motion({1, -2, 0.4}, 0.9, {});
  for (Vec3d& v : mesh.vertices) v = tilt.point({v.x, v.y, 0});
  const Whole sheet(
      make_sequence(mesh, 3, [&](std::uint32_t, std::uint32_t i) { return mesh.vertices[i]; }));
  const double before = sheet.area(sheet.maps);
  const double after =
      sheet.area(turned_to_small_boxes(sheet.points, sheet.maps, sheet.model_areas));
  EXPECT_LT(after, 0.62 * before);  // half is flat, and in the axes of the quads
}

TEST(BasisSearch, TurnsAndNeverMakesBoxesLarger) {
  for (std::uint32_t seed = 310; seed < 316; ++seed) {
    const Whole whole(wild_motion(seed, 45));  // more keys than are searched on
    const std::vector<Affine3d> turned =
        turned_to_small_boxes(whole.points, whole.maps, whole.model_areas);
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
