// How fast a clip walks that walks in place: a foot on the ground moves backwards under the body as
// fast as the body would move forwards.
#include <algorithm>
#include <cmath>

#include "preprocess/casts/cast.h"

namespace mdk {

std::optional<double> stride_speed(const ModelView& model, std::uint32_t clip_index, UpAxis up) {
  constexpr float kGroundShare = 0.03f;  // of the height: what counts as touching the ground
  constexpr double kSlowest = 0.05;      // heights a second: what stands does not walk
  const std::size_t up_axis = up == UpAxis::kY ? 1 : 2, side = up == UpAxis::kY ? 0 : 0,
                    other = up == UpAxis::kY ? 2 : 1;
  const Clip& clip = model.clips[clip_index];
  if (clip.key_count < 4) return {};
  const Aabb bounds = clip_bounds(model, clip_index);
  const float height = bounds.hi[up_axis] - bounds.lo[up_axis];
  const float ground = bounds.lo[up_axis] + kGroundShare * height;
  if (!(height > 0)) return {};

  std::vector<Vec3f> before(model.vertex_count), now(model.vertex_count);
  const auto pose = [&](std::uint32_t key, std::vector<Vec3f>& out) {
    decode_pose(model, key, {0, model.vertex_count}, out);
  };
  pose(clip.first_key, before);
  std::vector<double> velocity_side, velocity_other;
  for (std::uint32_t k = 1; k < clip.key_count; ++k, std::swap(before, now)) {
    const std::uint32_t key = clip.first_key + k;
    pose(key, now);
    const double seconds = model.key_times[key] - model.key_times[key - 1];
    double sum_side = 0, sum_other = 0;
    std::size_t touching = 0;
    for (std::size_t v = 0; v < now.size(); ++v) {
      if (!(before[v][up_axis] <= ground && now[v][up_axis] <= ground)) continue;
      sum_side +=
          (static_cast<double>(now[v][side]) - static_cast<double>(before[v][side])) / seconds;
      sum_other +=
          (static_cast<double>(now[v][other]) - static_cast<double>(before[v][other])) / seconds;
      ++touching;
    }
    if (touching == 0) continue;
    velocity_side.push_back(sum_side / static_cast<double>(touching));
    velocity_other.push_back(sum_other / static_cast<double>(touching));
  }
  // Off the ground for most of the time: it flies or swims.
  if (2 * velocity_side.size() < clip.key_count) return {};
  const auto middle = [](std::vector<double>& values) {
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), half, values.end());
    return *half;
  };
  const double speed = std::hypot(middle(velocity_side), middle(velocity_other));
  if (!(speed > kSlowest * static_cast<double>(height))) return {};
  return speed;
}

}  // namespace mdk
