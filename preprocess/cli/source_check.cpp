#include "preprocess/cli/source_check.h"

#include <algorithm>
#include <cstdio>

#include "common/math/vec3.h"
#include "common/motion/posed_mesh.h"

namespace mdk {
namespace {

CheckResult check_shape(const Model& model, const PoseSequence& source) {
  CheckResult shape{"the source has the same triangles, clips and key times", 0, 0, ""};
  const auto compare = [&](bool same, const std::string& difference) {
    ++shape.count;
    if (same) return;
    if (shape.passed()) shape.detail = difference;
    ++shape.failures;
  };
  compare(model.triangle_count() == source.triangles.size(),
          "the source has " + std::to_string(source.triangles.size()) + " triangles, the file " +
              std::to_string(model.triangle_count()));
  compare(
      std::equal(model.clips.begin(), model.clips.end(), source.clips.begin(), source.clips.end()),
      "the clips differ: give the --clips and --fps of the bake");
  compare(std::equal(model.key_times.begin(), model.key_times.end(), source.key_times.begin(),
                     source.key_times.end()),
          "the key times differ: give the --fps of the bake");
  return shape;
}

}  // namespace

std::vector<CheckResult> check_source(const Model& model, const PoseSequence& source) {
  const CheckResult shape = check_shape(model, source);
  if (!shape.passed()) return {shape};
  CheckResult positions{"corners stand where the source has them", 0, 0, ""};
  double largest = 0, allowed = 0;
  if (model.poses.kind == PoseKind::kQuantized)
    allowed = model.poses.quantized.error.front().bound * model.rest_diagonal;
  PosedMesh mesh(model);
  for (std::uint32_t key = 0; key < model.key_count(); ++key) {
    mesh.set_time(at_key(key));
    const auto baked = mesh.positions();
    const auto read = source.pose(key);
    for (std::uint32_t t = 0; t < model.triangle_count(); ++t)
      for (int corner = 0; corner < 3; ++corner) {
        const Vec3f& a = baked[model.triangles[t].v[corner]];
        const Vec3f& b = read[source.triangles[model.source_triangles[t]].v[corner]];
        ++positions.count;
        const double distance = length(to_double(a) - to_double(b));
        positions.failures += !(distance <= allowed);
        largest = std::max(largest, distance);
      }
  }
  char text[64];
  std::snprintf(text, sizeof text, "largest error %.3g of the diagonal",
                model.rest_diagonal > 0 ? largest / model.rest_diagonal : largest);
  positions.detail = text;
  return {shape, positions};
}

}  // namespace mdk
