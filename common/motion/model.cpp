// Views of stored models, and looking up times and keys in the clip table.
#include "common/motion/model.h"

#include <algorithm>
#include <cmath>

namespace mdk {

ModelView ModelStorage::view() const {
  ModelView model;
  assign_model(model, *this);
  return model;
}

std::vector<Aabb> ModelView::cluster_fuzzy_boxes(std::uint32_t segment, std::size_t cluster) const {
  const Cluster& range = clusters[cluster];
  std::vector<Aabb> boxes(range.triangle_count);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    boxes[i] = fuzzy_box(segment, cluster, range.first_triangle + i);
  return boxes;
}

KeyInterval locate_time(const ModelView& model, std::uint32_t clip_index, double seconds) {
  const Clip& clip = model.clips[clip_index];
  const auto times = model.key_times.subspan(clip.first_key, clip.key_count);
  const std::uint32_t last = clip.key_count - 1;
  if (!(seconds > times[0])) return at_key(clip.first_key);  // NaN comes here too
  if (seconds >= times[last]) return at_key(clip.first_key + last);

  const auto after = std::upper_bound(times.begin(), times.end(), seconds);
  const auto k1 = static_cast<std::uint32_t>(after - times.begin());
  const std::uint32_t k0 = k1 - 1;
  const double exact = (seconds - times[k0]) / (times[k1] - times[k0]);
  const auto s = static_cast<float>(exact);
  // Rounding to float may arrive at either key: the interval is half open, and a key stands for
  // itself.
  if (s <= 0.0f) return at_key(clip.first_key + k0);
  if (s >= 1.0f) return at_key(clip.first_key + k1);
  if (!model.holds_between_keys) return at_key(clip.first_key + (s > 0.5f ? k1 : k0));
  return {clip.first_key + k0, clip.first_key + k1, s};
}

double wrapped_time(double phase, double seconds, ClipWrap wrap) {
  if (!std::isfinite(phase) || !(seconds > 0)) return 0;
  switch (wrap) {
    case ClipWrap::kOnce:
      return std::clamp(phase, 0.0, seconds);
    case ClipWrap::kLoop: {
      if (phase >= 0 && phase < seconds) return phase;
      const double rest = std::fmod(phase, seconds);  // exact
      return rest < 0 ? rest + seconds : rest;
    }
    case ClipWrap::kPingPong: {
      const double round = wrapped_time(phase, 2 * seconds, ClipWrap::kLoop);
      return round <= seconds ? round : std::max(2 * seconds - round, 0.0);
    }
  }
  return 0;
}

std::uint32_t clip_of_key(const ModelView& model, std::uint32_t key) {
  const auto after = std::upper_bound(
      model.clips.begin(), model.clips.end(), key,
      [](std::uint32_t value, const Clip& clip) { return value < clip.first_key; });
  return static_cast<std::uint32_t>(after - model.clips.begin()) - 1;
}

bool has_time(const ModelView& model, const KeyInterval& at) {
  if (at.key0 >= model.key_count() || at.key1 >= model.key_count()) return false;
  if (at.key0 == at.key1) return at.s == 0;
  return at.key0 + 1 == at.key1 && at.s >= 0 && at.s < 1 &&
         clip_of_key(model, at.key0) == clip_of_key(model, at.key1);
}

std::uint32_t segment_of(const ModelView& model, const KeyInterval& at) {
  // The first segment that reaches key1 holds key0, too: the one before ends at key0 or earlier.
  const auto reaches = std::lower_bound(
      model.segments.begin(), model.segments.end(), at.key1,
      [](const Segment& segment, std::uint32_t key) { return segment.last_key < key; });
  return static_cast<std::uint32_t>(reaches - model.segments.begin());
}

void decode_pose(const ModelView& model, std::uint32_t key, VertexRange range,
                 std::span<Vec3f> out) {
  const PoseSource& poses = model.poses;
  switch (poses.kind) {
    case PoseKind::kKeyPositions: {
      const std::size_t first = static_cast<std::size_t>(key) * model.vertex_count + range.begin;
      std::ranges::copy(poses.key_positions.subspan(first, range.size()), out.begin());
      return;
    }
    case PoseKind::kRig:
      pose_vertices(poses.rig, rig_pose(poses.rig, key, model.key_count()), range, out);
      return;
    case PoseKind::kQuantized:
      decode_vertices(poses.quantized, key, range, out);
      return;
  }
}

Aabb clip_bounds(const ModelView& model, std::uint32_t clip) {
  Aabb bounds;
  const Clip& keys = model.clips[clip];
  for (const Aabb& box : model.key_boxes.subspan(keys.first_key, keys.key_count))
    bounds.extend(box);
  return bounds;
}

}  // namespace mdk
