// Where an instance is at a scene time, and why its boxes hold.
//
// Standing still. With W the map and B a box of the posed model, the box of the eight corners W(B)
// holds W(v) for every v in B: each coordinate is linear in v.
//
// Rounding on the way into the model. A ray o + t d becomes o' + t d' with o' = M o and d' = M d
// rounded to float, M the inverse of W. At a hit p' in the model, |o'| <= |p'| + t |d'|, so that
// the mapped ray is off by at most
//
//     sqrt(3) 2^-24 (|o'| + t |d'|)  <=  sqrt(3) 2^-24 (|p'| + 2 t |d'|)
//
// in the model, and |W| times that in the world. The first term does not depend on the ray: it is
// in the box, as |W| m 2^-22 with m the largest |v| of B. The second is at most unevenness * reach
// * 2^-22 and is left to ray_slack(), as is what the triangle test lets a hit be off by.
//
// On a path. In one interval between two keys, u in [0, 1],
//
//     p(u) = T(u) + R(u) c(u),   c(u) = S(u) (base b),   b a fixed point of B
//
// where T and c are linear in u, and R turns about one axis at a constant rate: by `turn` over the
// stretch [u0, u1] looked at, which is scaled to [0, 1] here. A curve lies no farther from the line
// between its ends, taken at the same u, than 1/8 of its largest second derivative:
//
//     p'' = R'' c + 2 R' c'     |R'' c| <= turn^2 |c|,   |R' c'| <= turn |c1 - c0|
//     |p(u) - ((1 - u) p0 + u p1)| <= (turn^2 max |c| + 2 turn |c1 - c0|) / 8         = sway
//
// So p(u) is within the sway of the hull of p0 and p1: the hull of the boxes of both ends, moved
// out by the sway, holds every point of B all the way. B holds the deforming model at every time of
// the stretch, so that whatever b the vertex is at at a time, it is in the box. (The sagitta of an
// arc, r (1 - cos(turn / 2)) <= r turn^2 / 8, is the special case without scaling; taking T along
// in the same hull is what keeps boxes of walkers tight.) Stretches that turn by more than kMaxTurn
// are cut.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "common/motion/model_handle.h"
#include "common/scene/scene.h"
#include "mdk/error.h"

namespace mdk {
namespace {

constexpr double kMaxTurn = 0.4;  // radians: a sway of 2 % of the size

/// The range of a quantity over an interval of time: one stretch, or two where it wraps.
struct Stretches {
  double from[2], to[2];
  int count = 1;
};

/// What wrapped_time() runs through while the phase runs from a to b, a <= b. The phase and fmod
/// are monotone as computed, so the values at the ends bound what lies between.
Stretches wrapped_range(double a, double b, double seconds, ClipWrap wrap) {
  const Stretches all{{0, 0}, {seconds, 0}, 1};
  if (!std::isfinite(a) || !std::isfinite(b) || !(seconds > 0)) return all;
  if (wrap == ClipWrap::kOnce)
    return {{std::clamp(a, 0.0, seconds), 0}, {std::clamp(b, 0.0, seconds), 0}, 1};
  constexpr double kNearlyOne = 0.999;  // a little early: the difference is rounded
  if (wrap == ClipWrap::kLoop) {
    if (b - a >= kNearlyOne * seconds) return all;
    const double from = wrapped_time(a, seconds, wrap), to = wrapped_time(b, seconds, wrap);
    if (from <= to) return {{from, 0}, {to, 0}, 1};
    return {{from, 0}, {seconds, to}, 2};
  }
  if (b - a >= kNearlyOne * 2 * seconds) return all;
  const double u0 = wrapped_time(a, 2 * seconds, ClipWrap::kLoop),
               u1 = wrapped_time(b, 2 * seconds, ClipWrap::kLoop);
  if (u0 > u1) {  // past the end of the round
    if (u0 < seconds || u1 > seconds) return all;
    return {{0, 0}, {std::max(2 * seconds - u0, u1), 0}, 1};
  }
  if (u1 <= seconds) return {{u0, 0}, {u1, 0}, 1};
  if (u0 >= seconds) return {{2 * seconds - u1, 0}, {2 * seconds - u0, 0}, 1};
  return {{std::min(u0, 2 * seconds - u1), 0}, {seconds, 0}, 1};
}

Aabbd to_double(const Aabb& box) { return {mdk::to_double(box.lo), mdk::to_double(box.hi)}; }

/// Moved out by what posing between keys in float, a + (b - a) s, may be off by: three roundings of
/// numbers up to twice the largest coordinate.
Aabbd posed_outward(Aabbd box) {
  if (box.empty()) return box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double slack = std::max(std::abs(box.lo[axis]), std::abs(box.hi[axis])) * 0x1p-21;
    box.lo[axis] -= slack;
    box.hi[axis] += slack;
  }
  return box;
}

/// Holds the posed model at a moment.
Aabbd model_box(const ModelView& model, const KeyInterval& at) {
  const Aabbd from = to_double(model.key_boxes[at.key0]);
  if (at.key0 == at.key1) return from;
  const Aabbd to = to_double(model.key_boxes[at.key1]);
  const double s = at.s;
  Aabbd box{from.lo + (to.lo - from.lo) * s, from.hi + (to.hi - from.hi) * s};
  // The slack is that of both ends: vertices cancel between them.
  const Aabbd ends{
      {std::min(from.lo.x, to.lo.x), std::min(from.lo.y, to.lo.y), std::min(from.lo.z, to.lo.z)},
      {std::max(from.hi.x, to.hi.x), std::max(from.hi.y, to.hi.y), std::max(from.hi.z, to.hi.z)}};
  const Aabbd outward = posed_outward(ends);
  return {box.lo + (outward.lo - ends.lo), box.hi + (outward.hi - ends.hi)};
}

/// The largest |v| of a box.
double largest_length(const Aabbd& box) {
  const Vec3d far{std::max(std::abs(box.lo.x), std::abs(box.hi.x)),
                  std::max(std::abs(box.lo.y), std::abs(box.hi.y)),
                  std::max(std::abs(box.lo.z), std::abs(box.hi.z))};
  return length(far);
}

/// At least the largest stretch of the linear part.
double frobenius(const Affine3d& m) {
  double sum = 0;
  for (int j = 0; j < 3; ++j) sum += dot(m.column(j), m.column(j));
  return std::sqrt(sum);
}

/// The box of the mapped box.
Aabbd mapped_box(const Affine3d& map, const Aabbd& box) {
  Aabbd out;
  for (int k = 0; k < 3; ++k) {
    double lo = map.m[k][3], hi = lo;
    for (int j = 0; j < 3; ++j) {
      const auto axis = static_cast<std::size_t>(j);
      const double a = map.m[k][j] * box.lo[axis], b = map.m[k][j] * box.hi[axis];
      lo += std::min(a, b);
      hi += std::max(a, b);
    }
    out.lo[static_cast<std::size_t>(k)] = lo;
    out.hi[static_cast<std::size_t>(k)] = hi;
  }
  return out;
}

/// Rounded to a box of floats. What lies beyond their range cannot be hit.
Aabb finished(Aabbd box, double slack) {
  constexpr double kMax = std::numeric_limits<float>::max();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double size = std::max(std::abs(box.lo[axis]), std::abs(box.hi[axis]));
    const double out = slack + size * 0x1p-45;  // what is summed in double here, and inverted
    box.lo[axis] = std::clamp(box.lo[axis] - out, -kMax, kMax);
    box.hi[axis] = std::clamp(box.hi[axis] + out, -kMax, kMax);
  }
  return round_outward(box);
}

Aabb standing_box(const Affine3f& map, const Aabbd& box) {
  if (box.empty()) return {};
  const Affine3d world_from_model = mdk::to_double(map);
  return finished(mapped_box(world_from_model, box),
                  frobenius(world_from_model) * largest_length(box) * 0x1p-22);
}

struct Quaternion {
  double v[4];

  friend double dot(const Quaternion& a, const Quaternion& b) {
    return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2] + a.v[3] * b.v[3];
  }
  /// wa a + wb b
  friend Quaternion blend(const Quaternion& a, double wa, const Quaternion& b, double wb) {
    Quaternion r;
    for (int i = 0; i < 4; ++i) r.v[i] = a.v[i] * wa + b.v[i] * wb;
    return r;
  }
  Quaternion unit() const {
    const double scale = 1 / std::sqrt(dot(*this, *this));
    return {{v[0] * scale, v[1] * scale, v[2] * scale, v[3] * scale}};
  }
};

Quaternion rotation_of(const PathKey& key) {
  return Quaternion{{key.rotation[0], key.rotation[1], key.rotation[2], key.rotation[3]}}.unit();
}

/// sin(t angle) / sin(angle) for a cosine of at least 0.7: its power series about cosine 1 has
/// terms that fall by 0.147 each, so that nine leave less than 1e-7. No function of the C library:
/// the bits are the same on every machine.
double slerp_weight(double t, double cosine) {
  double term = t, sum = t;
  for (int i = 1; i <= 9; ++i) {
    term *= (t * t - i * i) / (i * (2 * i + 1)) * (cosine - 1);
    sum += term;
  }
  return sum;
}

/// Turns at a constant rate from a to b by the shorter way, a.b >= 0; each half has a cosine of at
/// least 0.707.
Quaternion slerp(const Quaternion& a, const Quaternion& b, double u) {
  const Quaternion middle = blend(a, 1, b, 1).unit();
  const double cosine = std::min(dot(a, middle), 1.0);
  if (u < 0.5) {
    const double t = 2 * u;
    return blend(a, slerp_weight(1 - t, cosine), middle, slerp_weight(t, cosine)).unit();
  }
  const double t = 2 * u - 1;
  return blend(middle, slerp_weight(1 - t, cosine), b, slerp_weight(t, cosine)).unit();
}

/// translation + rotation (scale p)
Affine3d composed(const Vec3d& translation, const Quaternion& rotation, const Vec3d& scale) {
  const auto [x, y, z, w] = rotation.v;
  const double r[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                          {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                          {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  Affine3d m;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) m.m[i][j] = r[i][j] * scale[static_cast<std::size_t>(j)];
    m.m[i][3] = translation[static_cast<std::size_t>(i)];
  }
  return m;
}

/// The way from one key to the next, or a key alone.
class PathStretch {
 public:
  PathStretch(const PathKey& from, const PathKey& to)
      : from_(from), to_(to), a_(rotation_of(from)), b_(rotation_of(to)) {
    if (dot(a_, b_) < 0) b_ = blend(b_, -1, b_, 0);
  }

  double share_of(double time) const {
    const double span = to_.time - from_.time;
    return span > 0 ? std::clamp((time - from_.time) / span, 0.0, 1.0) : 0;
  }
  Vec3d scale(double u) const {
    return mixed(mdk::to_double(from_.scale), mdk::to_double(to_.scale), u);
  }
  Affine3d at(double u) const {
    const Quaternion rotation = u == 0 ? a_ : u == 1 ? b_ : slerp(a_, b_, u);
    return composed(mixed(mdk::to_double(from_.translation), mdk::to_double(to_.translation), u),
                    rotation, scale(u));
  }
  /// No less than the whole turn in radians. Half the distance of the quaternions is sin(turn / 4),
  /// up to 0.7072; asin(x) <= x + 0.222 x^3 there. A hundredth more for slerp()'s error.
  double turn() const {
    const Quaternion apart = blend(b_, 1, a_, -1);
    const double x = std::sqrt(dot(apart, apart)) / 2;
    return 4.04 * (x + 0.222 * x * x * x);
  }

 private:
  static Vec3d mixed(const Vec3d& a, const Vec3d& b, double u) {
    return u == 0 ? a : u == 1 ? b : a + (b - a) * u;
  }

  const PathKey &from_, &to_;
  Quaternion a_, b_;
};

/// The key before a time, or the first one.
std::size_t key_before(std::span<const PathKey> keys, double time) {
  const auto after = std::ranges::upper_bound(keys, time, {}, &PathKey::time);
  return after == keys.begin() ? 0 : static_cast<std::size_t>(after - keys.begin()) - 1;
}

double path_time(std::span<const PathKey> keys, PathEnds ends, double time) {
  const double first = keys.front().time, last = keys.back().time;
  if (ends == PathEnds::kLoop)
    time = first + wrapped_time(time - first, last - first, ClipWrap::kLoop);
  return std::clamp(time, first, last);
}

/// Where a box goes on a stretch between u0 and u1 (top of this file).
void extend_by_sweep(Aabbd& box, double& slack, const PathStretch& stretch, double u0, double u1,
                     const Affine3d& base, const Aabbd& model_box) {
  Aabbd in_path = mapped_box(base, model_box);
  const double far = largest_length(in_path), model_far = largest_length(model_box);
  const double whole_turn = stretch.turn() * (u1 - u0);
  const int pieces = std::max(1, static_cast<int>(std::ceil(whole_turn / kMaxTurn)));
  const double turn = whole_turn / pieces;
  for (int i = 0; i <= pieces; ++i) {
    const double u = i == pieces ? u1 : u0 + (u1 - u0) * i / pieces;
    const Affine3d map = stretch.at(u) * base;
    box.extend(mapped_box(map, model_box));
    const Vec3d scale = stretch.scale(u), other = stretch.scale(i == 0 ? u1 : u0);
    const double size = std::max({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)}) * far;
    const Vec3d change = scale - other;  // of the whole stretch: no less than a piece's
    const double growth =
        std::max({std::abs(change.x), std::abs(change.y), std::abs(change.z)}) * far;
    const double sway = (turn * turn * size + 2 * turn * growth) / 8;
    // Rounding the map to float moves points by its entries' last bits; slerp() is not quite even.
    const double rounding = (frobenius(map) * model_far + length(map.column(3)) + size) * 0x1p-22;
    slack = std::max(slack, sway + rounding + size * 0x1p-20);
  }
}

}  // namespace

Affine3f key_map(const PathKey& key) {
  return to_float(composed(mdk::to_double(key.translation), rotation_of(key),
                           mdk::to_double(key.scale)));
}

Stage::Stage(const SceneView& scene, std::vector<Model> models)
    : scene_(scene), models_(std::move(models)) {
  if (const std::string fault = role_fault(scene_, models_); !fault.empty())
    throw Error(ErrorCode::kBadInput, fault);
  for (const SceneRole& role : scene_.roles) {
    const ModelView& model = ModelHandle::view(models_[role.model]);
    const Clip& clip = model.clips[role.clip];
    Aabbd bounds = to_double(clip_bounds(model, role.clip));
    if (clip.key_count > 1) bounds = posed_outward(bounds);
    roles_.push_back({&model, model.clip_seconds(clip), bounds});
  }
  for (const ScenePath& path : scene_.paths) {
    double most = 1;
    for (const PathKey& key : scene_.keys_of(path))
      most = std::max(
          most, mdk::unevenness(to_float(composed({}, {{0, 0, 0, 1}}, mdk::to_double(key.scale)))));
    path_unevenness_.push_back(most);
  }
}

bool Stage::is_shown(std::uint32_t i, double time) const {
  if (!is_moving(i)) return true;
  const ScenePath& path = path_of(i);
  if (path.ends != PathEnds::kHide) return true;
  const auto keys = scene_.keys_of(path);
  return keys.front().time <= time && time <= keys.back().time;
}

double Stage::clip_time(std::uint32_t i, double time) const {
  const SceneInstance& instance = scene_.instances[i];
  return wrapped_time(instance.start + static_cast<double>(instance.speed) * time,
                      roles_[instance.role()].seconds, instance.wrap());
}

Affine3f Stage::world_from_model(std::uint32_t i, double time) const {
  const SceneInstance& instance = scene_.instances[i];
  if (!instance.has_path()) return instance.map;
  const ScenePath& path = path_of(i);
  const auto keys = scene_.keys_of(path);
  const double at = path_time(keys, path.ends, time);
  const std::size_t k = key_before(keys, at);
  const PathStretch stretch(keys[k], keys[std::min(k + 1, keys.size() - 1)]);
  return to_float(stretch.at(stretch.share_of(at)) * mdk::to_double(instance.map));
}

Aabb Stage::box_at(std::uint32_t i, double time) const {
  if (!is_shown(i, time)) return {};
  return standing_box(world_from_model(i, time), model_box(model_of(i), key_interval(i, time)));
}

Aabbd Stage::model_box_over(std::uint32_t i, double from, double to) const {
  const SceneInstance& instance = scene_.instances[i];
  const RoleFacts& facts = roles_[instance.role()];
  const double a = instance.start + static_cast<double>(instance.speed) * from,
               b = instance.start + static_cast<double>(instance.speed) * to;
  const Stretches range =
      wrapped_range(std::min(a, b), std::max(a, b), facts.seconds, instance.wrap());
  if (!std::isfinite(a) || !std::isfinite(b) ||
      (range.count == 1 && range.from[0] <= 0 && range.to[0] >= facts.seconds))
    return facts.bounds;
  const std::uint32_t clip = role(i).clip;
  Aabbd box;
  for (int r = 0; r < range.count; ++r) {
    const KeyInterval first = locate_time(*facts.model, clip, range.from[r]),
                      last = locate_time(*facts.model, clip, range.to[r]);
    box.extend(model_box(*facts.model, first));
    box.extend(model_box(*facts.model, last));
    for (std::uint32_t key = first.key1; key <= last.key0; ++key)
      box.extend(to_double(facts.model->key_boxes[key]));
  }
  // In between, posing may round otherwise than at both ends.
  return posed_outward(box);
}

Aabb Stage::moving_box(const SceneInstance& instance, const ScenePath& path, const Aabbd& model_box,
                       double from, double to) const {
  if (model_box.empty()) return {};
  const auto keys = scene_.keys_of(path);
  const double first = keys.front().time, last = keys.back().time;
  Stretches range{{std::clamp(from, first, last), 0}, {std::clamp(to, first, last), 0}, 1};
  if (path.ends == PathEnds::kLoop) {
    range = wrapped_range(from - first, to - first, last - first, ClipWrap::kLoop);
    for (int r = 0; r < range.count; ++r) {
      range.from[r] = std::clamp(first + range.from[r], first, last);
      range.to[r] = std::clamp(first + range.to[r], first, last);
    }
  }
  const Affine3d base = mdk::to_double(instance.map);
  Aabbd box;
  double slack = 0;
  for (int r = 0; r < range.count; ++r)
    for (std::size_t k = key_before(keys, range.from[r]);; ++k) {
      const PathStretch stretch(keys[k], keys[std::min(k + 1, keys.size() - 1)]);
      extend_by_sweep(box, slack, stretch, stretch.share_of(range.from[r]),
                      stretch.share_of(range.to[r]), base, model_box);
      if (k + 1 >= keys.size() || keys[k + 1].time >= range.to[r]) break;
    }
  return finished(box, slack);
}

Aabb Stage::box_over(std::uint32_t i, double from, double to) const {
  const SceneInstance& instance = scene_.instances[i];
  if (!instance.has_path()) return standing_box(instance.map, model_box_over(i, from, to));
  const ScenePath& path = path_of(i);
  if (path.ends == PathEnds::kHide) {
    const auto keys = scene_.keys_of(path);
    from = std::max(from, keys.front().time);
    to = std::min(to, keys.back().time);
    if (from > to) return {};
  }
  return moving_box(instance, path, model_box_over(i, from, to), from, to);
}

Aabb Stage::box_always(std::uint32_t i) const {
  const SceneInstance& instance = scene_.instances[i];
  const Aabbd& bounds = roles_[instance.role()].bounds;
  if (!instance.has_path()) return standing_box(instance.map, bounds);
  const ScenePath& path = path_of(i);
  const auto keys = scene_.keys_of(path);
  return moving_box(instance, {path.first_key, path.key_count, PathEnds::kHold}, bounds,
                    keys.front().time, keys.back().time);
}

double Stage::unevenness(std::uint32_t i) const {
  const SceneInstance& instance = scene_.instances[i];
  const double own = mdk::unevenness(instance.map);
  return instance.has_path() ? own * path_unevenness_[scene_.labels[i].path] : own;
}

}  // namespace mdk
