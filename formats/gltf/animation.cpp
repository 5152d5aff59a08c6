#include "formats/gltf/animation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "common/base/error.h"
#include "formats/gltf/document.h"

namespace mdk::gltf {
namespace {

// Times are floats in the file: 1/30 s written there and computed here differ by less than this.
constexpr double kSameTime = 1e-6;
constexpr std::size_t kMaxKeys = std::size_t{1} << 24;
// Tracks may share one accessor: what they unfold to, in numbers.
constexpr std::size_t kMaxNumbers = std::size_t{1} << 28;

double time_tolerance(double time) {
  return std::max(kSameTime, std::abs(time) * std::numeric_limits<float>::epsilon());
}

class TrackReader {
 public:
  TrackReader(const Document& document, std::size_t animation)
      : document_(document), place_("animation " + std::to_string(animation)) {}

  Track read(const Channel& channel) const {
    Track track;
    track.node = channel.node;
    track.path = channel.path;
    track.interpolation = channel.interpolation;
    const Node& node = entry(document_.nodes, channel.node);
    track.components = track.path == TrackPath::kRotation  ? 4
                       : track.path == TrackPath::kWeights ? node.weights.size()
                                                           : 3;
    read_times(channel, track);
    read_values(channel, track);
    return track;
  }

 private:
  [[noreturn]] void fail(const std::string& sentence) const {
    throw bad_input(document_.path, place_ + " " + sentence);
  }

  void read_times(const Channel& channel, Track& track) const {
    const Accessor& input =
        expect_components(document_, channel.input, 1, place_ + ": its list of times");
    if (input.type != ComponentType::kFloat32) fail("has times that are not floats");
    const std::vector<float> times = read_floats(document_, channel.input);
    track.times.assign(times.begin(), times.end());
    if (!std::ranges::is_sorted(track.times)) fail("has times that run backwards");
  }

  /// Morph weights are one number an element, n elements a key; all else is one element a key.
  void read_values(const Channel& channel, Track& track) const {
    const bool weights = track.path == TrackPath::kWeights;
    const Accessor& output = expect_components(document_, channel.output,
                                               weights ? 1 : static_cast<int>(track.components),
                                               place_ + ": its list of values");
    const std::size_t per_key = track.interpolation == Interpolation::kCubicSpline ? 3 : 1;
    const std::size_t wanted = track.times.size() * per_key * (weights ? track.components : 1);
    if (output.count != wanted)
      fail("has " + std::to_string(output.count) + " values where its times need " +
           std::to_string(wanted));
    track.values = read_floats(document_, channel.output);
  }

  const Document& document_;
  const std::string place_;
};

Error too_many_keys(const Document& document) {
  return {ErrorCode::kOverLimit, document.path + ": needs more than " + std::to_string(kMaxKeys) +
                                     " keys; choose a lower --fps or fewer --clips"};
}

/// A grid of 1 / fps from 0 to `seconds`, and `seconds` itself where the grid misses it.
std::vector<double> key_grid(const Document& document, double seconds, double fps) {
  const double steps = std::floor((seconds + kSameTime) * fps);
  if (!(steps < static_cast<double>(kMaxKeys))) throw too_many_keys(document);
  std::vector<double> times;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(steps); ++i)
    times.push_back(static_cast<double>(i) / fps);
  if (seconds - times.back() > kSameTime) times.push_back(seconds);
  return times;
}

/// A name for each animation: its own, "clip 3" where it has none, with a number where it is taken.
std::vector<std::string> clip_names(const Document& document) {
  if (document.animations.empty()) return {"static"};
  std::vector<std::string> names;
  std::set<std::string> taken;
  std::map<std::string, std::size_t> copies;
  for (std::size_t a = 0; a < document.animations.size(); ++a) {
    std::string name = document.animations[a].name;
    if (name.empty()) name = "clip " + std::to_string(a + 1);
    const std::string plain = name;
    while (!taken.insert(name).second) name = plain + " " + std::to_string(++copies[plain] + 1);
    names.push_back(std::move(name));
  }
  return names;
}

void check_names(const Document& document, const std::vector<std::string>& wanted,
                 const std::vector<std::string>& names) {
  for (const std::string& name : wanted) {
    if (std::ranges::find(names, name) != names.end()) continue;
    std::string all;
    for (const std::string& n : names) all += (all.empty() ? "\"" : ", \"") + n + "\"";
    throw Error(ErrorCode::kUsage, document.path + ": has no clip \"" + name + "\"; there are " +
                                       (all.empty() ? "none" : all));
  }
}

std::size_t count_numbers(const Document& document, const Animation& animation) {
  std::size_t numbers = 0;
  for (const Channel& channel : animation.channels) {
    const Accessor& output = entry(document.accessors, channel.output);
    numbers += entry(document.accessors, channel.input).count +
               output.count * static_cast<std::size_t>(output.components);
  }
  return numbers;
}

AnimationClip read_clip(const Document& document, std::size_t number, const std::string& name,
                        double fps) {
  AnimationClip clip;
  clip.name = name;
  const TrackReader reader(document, number);
  for (const Channel& channel : document.animations[number].channels) {
    const Node& node = entry(document.nodes, channel.node);
    if (channel.path == TrackPath::kWeights && node.weights.empty()) continue;
    clip.tracks.push_back(reader.read(channel));
  }
  double end = -std::numeric_limits<double>::infinity();
  clip.start = -end;
  for (const Track& track : clip.tracks) {
    clip.start = std::min(clip.start, track.times.front());
    end = std::max(end, track.times.back());
  }
  if (clip.tracks.empty()) clip.start = end = 0;
  clip.key_times = key_grid(document, end - clip.start, fps);
  return clip;
}

void normalize_rotation(std::span<double> q) {
  const Quaternion unit = normalized(Quaternion{q[0], q[1], q[2], q[3]});
  q[0] = unit.x;
  q[1] = unit.y;
  q[2] = unit.z;
  q[3] = unit.w;
}

std::span<const float> value_at(const Track& track, std::size_t key) {
  const std::size_t row = track.interpolation == Interpolation::kCubicSpline ? 3 * key + 1 : key;
  return std::span(track.values).subspan(row * track.components, track.components);
}

void slerp_between(const Track& track, std::size_t key, double s, std::span<double> value) {
  const auto unit = [&](std::size_t k) {
    const std::span<const float> v = value_at(track, k);
    return normalized(Quaternion{v[0], v[1], v[2], v[3]});
  };
  const Quaternion q = slerp(unit(key), unit(key + 1), s);
  value[0] = q.x;
  value[1] = q.y;
  value[2] = q.z;
  value[3] = q.w;
}

/// glTF 2.0 appendix C.5: the Hermite spline through both values, with the first's out-tangent and
/// the second's in-tangent scaled by the time between them.
void hermite_between(const Track& track, std::size_t key, double s, std::span<double> value) {
  const double span = track.times[key + 1] - track.times[key];
  const std::size_t n = track.components;
  const float* v0 = &track.values[(3 * key + 1) * n];
  const float* out_tangent = v0 + n;
  const float* in_tangent = out_tangent + n;
  const float* v1 = in_tangent + n;
  const double s2 = s * s, s3 = s2 * s;
  for (std::size_t c = 0; c < n; ++c)
    value[c] = (2 * s3 - 3 * s2 + 1) * v0[c] + span * (s3 - 2 * s2 + s) * out_tangent[c] +
               (-2 * s3 + 3 * s2) * v1[c] + span * (s3 - s2) * in_tangent[c];
}

}  // namespace

std::vector<AnimationClip> read_clips(const Document& document, const ReadOptions& options) {
  const std::vector<std::string> names = clip_names(document);
  check_names(document, options.clips, names);
  if (document.animations.empty()) return {AnimationClip{names[0], 0, {0.0}, {}}};
  std::vector<AnimationClip> clips;
  std::size_t numbers = 0, keys = 0;
  for (std::size_t a = 0; a < names.size(); ++a) {
    if (!options.clips.empty() && std::ranges::find(options.clips, names[a]) == options.clips.end())
      continue;
    numbers += count_numbers(document, document.animations[a]);
    if (numbers > kMaxNumbers)
      throw Error(ErrorCode::kOverLimit,
                  document.path + ": has too much animation data; choose fewer --clips");
    clips.push_back(read_clip(document, a, names[a], options.fps));
    keys += clips.back().key_times.size();
    if (keys > kMaxKeys) throw too_many_keys(document);
  }
  return clips;
}

void sample(const Track& track, double time, std::span<double> value) {
  // The last key at or before the time; a key within the tolerance counts as reached, so that the
  // file's own keys are hit where they lie on the grid.
  const auto after =
      std::upper_bound(track.times.begin(), track.times.end(), time + time_tolerance(time));
  const auto key =
      static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - track.times.begin() - 1));
  const bool is_rotation = track.path == TrackPath::kRotation;
  const bool at_key = time <= track.times[key] + time_tolerance(time);
  if (at_key || key + 1 == track.times.size() || track.interpolation == Interpolation::kStep) {
    std::ranges::copy(value_at(track, key), value.begin());
    if (is_rotation) normalize_rotation(value);
    return;
  }
  const double s = (time - track.times[key]) / (track.times[key + 1] - track.times[key]);
  if (track.interpolation == Interpolation::kCubicSpline) {
    hermite_between(track, key, s, value);
    if (is_rotation) normalize_rotation(value);
  } else if (is_rotation) {
    slerp_between(track, key, s, value);
  } else {
    const std::span<const float> from = value_at(track, key), to = value_at(track, key + 1);
    for (std::size_t c = 0; c < value.size(); ++c)
      value[c] = from[c] + s * (static_cast<double>(to[c]) - from[c]);
  }
}

}  // namespace mdk::gltf
