// Model: an animated mesh from a .mdk file, ready to be traced by a RayQuery.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mdk/geometry.h"

namespace mdk {

/// Where a time lies between keys: pose(t) = key0 + s (key1 - key0). At a key exactly, key0 == key1
/// and s == 0; else key1 follows key0 in the same clip.
struct KeyInterval {
  std::uint32_t key0 = 0, key1 = 0;
  float s = 0;  ///< in [0, 1)

  friend constexpr bool operator==(const KeyInterval& a, const KeyInterval& b) {
    return a.key0 == b.key0 && a.key1 == b.key1 && a.s == b.s;
  }
  friend constexpr bool operator!=(const KeyInterval& a, const KeyInterval& b) { return !(a == b); }
};

/// What becomes of a clip time outside of the clip, which lasts D seconds.
enum class ClipWrap : std::uint32_t {
  kLoop = 0,      ///< begins again every D seconds
  kOnce = 1,      ///< stands at the clip's first or last key
  kPingPong = 2,  ///< runs forwards, then backwards: 2 D seconds a round
};

/// A run of keys that are played together.
struct ClipInfo {
  std::string name;
  double seconds = 0;           ///< from 0, its first key, to its last key
  std::uint32_t first_key = 0;  ///< among the model's keys
  std::uint32_t key_count = 0;  ///< at least one
};

/// Copies are cheap and share what was loaded, which lives as long as any of them. Nothing changes
/// it: all members may be called from many threads at once. Throws Error (kUsage) for a clip, key
/// or triangle that is not there.
class Model {
 public:
  /// Maps the file and checks it. Cost: a pass over tables and links; the bulk is read when it is
  /// needed. The file must not change while a copy lives. Throws Error: kIo (cannot be read),
  /// kBadInput (not a .mdk file, of another version, or damaged).
  static Model load(const std::string& path);

  // No moves: a model is never empty.
  Model(const Model&) = default;
  Model& operator=(const Model&) = default;

  std::uint32_t vertex_count() const;
  std::uint32_t triangle_count() const;
  std::uint32_t key_count() const;   ///< of all clips
  std::uint32_t clip_count() const;  ///< at least one
  std::uint32_t cluster_count() const;
  std::uint32_t material_count() const;
  /// Linear RGBA, without texture and vertex colours.
  std::array<float, 4> material_color(std::uint32_t material) const;

  ClipInfo clip(std::uint32_t clip) const;
  /// The first clip of this name, or none.
  std::optional<std::uint32_t> find_clip(const std::string& name) const;

  /// Holds the mesh at every time of all clips.
  Aabb bounds() const;
  /// Holds the mesh at every time of a clip. Cost: O(keys of the clip).
  Aabb clip_bounds(std::uint32_t clip) const;

  /// The interval of a clip that holds `seconds`, clamped to the clip; the nearest key where the
  /// model's boxes hold at keys only (baked with --between-keys off). Cost: O(log keys). Throws
  /// Error (kUsage) for a time that is not finite, too.
  KeyInterval locate_time(std::uint32_t clip, double seconds) const;
  /// The same, of a time that `wrap` brings into the clip.
  KeyInterval locate_time(std::uint32_t clip, double seconds, ClipWrap wrap) const;
  /// Exactly at a key.
  KeyInterval at_key(std::uint32_t key) const;
  /// Seconds of a key, from its clip's first one.
  double key_time(std::uint32_t key) const;

  /// Where all vertices are at a time that locate_time() or at_key() gave, as they are traced.
  /// Cost: O(vertices).
  std::vector<Vec3f> vertices(const KeyInterval& time) const;
  /// The vertices of a triangle's corners, counter-clockwise seen from outside.
  std::array<std::uint32_t, 3> triangle(std::uint32_t triangle) const;

  /// The number that a triangle had in the mesh that was baked. Hits count triangles in the order
  /// of the file.
  std::uint32_t source_triangle(std::uint32_t triangle) const;

 private:
  friend struct ModelHandle;  // the library's own way in
  struct Data;
  explicit Model(std::shared_ptr<const Data> data);
  std::shared_ptr<const Data> data_;
};

}  // namespace mdk
