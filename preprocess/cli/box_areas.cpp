#include "preprocess/cli/box_areas.h"

#include <vector>

#include "common/base/parallel.h"
#include "preprocess/cli/median.h"
#include "preprocess/cost.h"

namespace mdk {
namespace {

/// Area of all fuzzy boxes of one key's segment, in the world.
double fuzzy_area_at(const Model& model, std::uint32_t key) {
  const std::uint32_t segment = segment_of(model, at_key(key));
  const auto maps = model.key_maps(key);
  double sum = 0;
  for (std::size_t c = 0; c < model.clusters.size(); ++c) {
    FaceSums sums;
    for (const Aabb& box : model.cluster_fuzzy_boxes(segment, c)) sums.add(box);
    sum += sums.area(world_area_weights(to_double(maps[c])));
  }
  return sum;
}

struct KeyAreas {
  double tight = 0, whole = 0;
};

KeyAreas tight_area_at(const Model& model, std::uint32_t key) {
  std::vector<Vec3f> pose(model.vertex_count);
  decode_pose(model, key, {0, model.vertex_count}, pose);
  KeyAreas areas;
  Aabb whole;
  for (const Triangle& triangle : model.triangles) {
    Aabb box;
    for (const std::uint32_t v : triangle.v) box.extend(pose[v]);
    areas.tight += static_cast<double>(box.surface_area());
    whole.extend(box);
  }
  areas.whole = static_cast<double>(whole.surface_area());
  return areas;
}

}  // namespace

BoxAreas measure_box_areas(const Model& model) {
  const std::size_t keys = model.key_count();
  std::vector<double> fuzzy(keys), tight(keys);
  parallel_chunks(keys, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto key = static_cast<std::uint32_t>(i);
      const KeyAreas areas = tight_area_at(model, key);
      if (!(areas.whole > 0)) continue;
      fuzzy[i] = fuzzy_area_at(model, key) / areas.whole;
      tight[i] = areas.tight / areas.whole;
    }
  });
  return {median(fuzzy), median(tight)};
}

}  // namespace mdk
