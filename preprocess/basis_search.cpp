#include "preprocess/basis_search.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace mdk {
namespace {

constexpr std::uint32_t kSearchRows = 32;
// Tangents of half the angles that are tried: 53 degrees, halved again and again down to 2.
constexpr double kFirstStep = 0.5, kLastStep = 0.015;

/// About one axis, by 2 atan(t): rational in t, so the same on every machine.
Affine3d turn_about(int axis, double t) {
  const int j = (axis + 1) % 3, k = (axis + 2) % 3;
  const double cosine = (1 - t * t) / (1 + t * t), sine = 2 * t / (1 + t * t);
  Affine3d turn;
  turn.m[j][j] = turn.m[k][k] = cosine;
  turn.m[j][k] = -sine;
  turn.m[k][j] = sine;
  return turn;
}

std::vector<Affine3d> followed_by(const Affine3d& turn, std::span<const Affine3d> maps) {
  std::vector<Affine3d> result;
  result.reserve(maps.size());
  for (const Affine3d& map : maps) result.push_back(turn * map);
  return result;
}

/// A cluster in some of its rows.
struct SearchSample {
  ClusterPoints points;
  std::vector<Affine3d> maps;
  std::vector<double> model_areas;
};

SearchSample make_sample(const ClusterPoints& points, std::span<const Affine3d> maps,
                         std::span<const double> model_areas) {
  SearchSample sample;
  std::vector<std::uint32_t> rows;
  const std::uint32_t step = (points.row_count + kSearchRows - 1) / kSearchRows;
  for (std::uint32_t row = 0; row < points.row_count; row += step) {
    rows.push_back(row);
    sample.maps.push_back(maps[row]);
    sample.model_areas.push_back(model_areas[row]);
  }
  sample.points = gather_rows(points, rows);
  return sample;
}

}  // namespace

double fuzzy_area(const ClusterPoints& points, std::span<const Affine3d> maps,
                  std::span<const double> model_areas, const CostOptions& cost) {
  const PointBoxes boxes = mapped_boxes(points, maps);
  FaceSums sums;
  for (std::size_t t = 0; t < points.triangle_count(); ++t)
    sums.add(boxes.triangle(&points.corners[3 * t]));
  return sums.area(mean_area_weights(maps, model_areas, cost));
}

std::vector<Affine3d> turned_to_small_boxes(const ClusterPoints& points,
                                            std::span<const Affine3d> maps,
                                            std::span<const double> model_areas,
                                            const CostOptions& cost) {
  SearchSample sample = make_sample(points, maps, model_areas);
  double least = fuzzy_area(sample.points, sample.maps, sample.model_areas, cost);
  Affine3d best;
  for (double step = kFirstStep; step > kLastStep; step /= 2)
    for (int axis = 0; axis < 3; ++axis)
      for (const double t : {step, -step}) {
        const Affine3d turn = turn_about(axis, t);
        std::vector<Affine3d> turned = followed_by(turn, sample.maps);
        const double area = fuzzy_area(sample.points, turned, sample.model_areas, cost);
        if (!(area < least)) continue;
        least = area;
        sample.maps = std::move(turned);
        best = turn * best;
        break;
      }
  std::vector<Affine3d> result = followed_by(best, maps);
  if (fuzzy_area(points, result, model_areas, cost) < fuzzy_area(points, maps, model_areas, cost))
    return result;
  return {maps.begin(), maps.end()};
}

}  // namespace mdk
