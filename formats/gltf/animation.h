// Animations as tracks over time, and the times at which they are sampled (glTF 2.0 §3.11, app. C).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "formats/gltf/document.h"
#include "formats/gltf/reader.h"

namespace mdk::gltf {

/// What one property of one node does over time.
struct Track {
  int node = kNone;
  TrackPath path = TrackPath::kTranslation;
  Interpolation interpolation = Interpolation::kLinear;
  std::size_t components = 3;  ///< 3, 4, or the number of morph targets
  std::vector<double> times;   ///< seconds, not falling; at least one
  std::vector<float> values;   ///< per time: one value; CUBICSPLINE: in-tangent, value, out-tangent
};

struct AnimationClip {
  std::string name;               ///< no two alike
  double start = 0;               ///< file time of the first key, seconds
  std::vector<double> key_times;  ///< seconds from `start`, rising from 0
  std::vector<Track> tracks;
};

/// The animations that `options` ask for, in the file's order; one clip "static" with one key where
/// the file has none. Throws Error: kUsage for an unknown name, kBadInput, kOverLimit for more than
/// 2^24 keys.
std::vector<AnimationClip> read_clips(const Document& document, const ReadOptions& options);

/// The track's value at a file time, clamped to its first and last; rotations of length one.
/// `value`: `components` numbers. Cost: O(log keys).
void sample(const Track& track, double time, std::span<double> value);

}  // namespace mdk::gltf
