// Every vertex is bent by one formula of its place at rest and the key: first what it belongs to
// (wing, leg, eye), then head and neck, then the whole body.
#include "assets/chicken_asset.h"

#include <algorithm>

#include "assets/chicken_shape.h"
#include "assets/wave.h"

namespace mdk {
namespace {

constexpr int kKeys = 400;

/// `p` turned about an axis through `center`, 0 (x), 1 (y) or 2 (z).
Vec3d turned(const Vec3d& p, const Vec3d& center, std::size_t axis, double turns) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double c = cosine(turns), s = sine(turns);
  const Vec3d q = p - center;
  Vec3d out = p;
  out[u] = center[u] + c * q[u] - s * q[v];
  out[v] = center[v] + s * q[u] + c * q[v];
  return out;
}

/// Up, hold, down.
double pulse(double key, double rise, double full, double fall, double calm) {
  return smooth_step(rise, full, key) * (1 - smooth_step(fall, calm, key));
}

/// What the chicken feels at a key; all but `key` are 0 at rest.
struct Mood {
  double key = 0;
  double peck = 0;    ///< the beak reaches the ground at 1
  double look = 0;    ///< turns of the head about the neck
  double fright = 0;  ///< the neck is at its longest at 1
  double ooze = 0;    ///< the eyes follow the fright, later and longer
  double ruffle = 0;  ///< every feather stands up
  double dizzy = 0;
};

Mood mood_at(double key) {
  Mood mood;
  mood.key = key;
  for (const double at : {18.0, 52.0, 78.0, 128.0})
    mood.peck = std::max(mood.peck, pulse(key, at, at + 8, at + 12, at + 22));
  mood.look = 0.14 * (pulse(key, 155, 162, 178, 186) - pulse(key, 182, 190, 206, 214)) +
              0.10 * pulse(key, 345, 355, 368, 378);
  mood.fright = pulse(key, 226, 240, 256, 276);
  mood.fright += 0.16 * sine((key - 240) / 9) * pulse(key, 238, 244, 262, 284);
  mood.ooze = pulse(key, 236, 254, 264, 292);
  mood.ruffle = pulse(key, 228, 236, 258, 282);
  mood.dizzy = pulse(key, 280, 290, 310, 350);
  return mood;
}

/// Three waves of different lengths run through the plumage, so that no part of it moves as one.
Vec3d ruffle(const Vec3d& p, const Mood& mood) {
  const double feathers =
      smooth_step(0.12, kHip, p.y) * (1 - 0.6 * smooth_step(kNeckBase.y, kNeckTop.y, p.y));
  const double wave[3] = {sine(3.1 * p.y + 2.3 * p.x - mood.key / 9),
                          sine(4.3 * p.x - 2.9 * p.z + mood.key / 7),
                          sine(3.7 * p.z + 2.1 * p.y + mood.key / 8)};
  const Vec3d up{0.03 * wave[1] + 0.015 * wave[2], 0.03 * wave[2] + 0.015 * wave[0],
                 0.03 * wave[0] + 0.015 * wave[1]};
  return p + up * (mood.ruffle * feathers);
}

Vec3d flap_wing(const Vec3d& p, const Mood& mood) {
  const double side = p.z < 0 ? -1 : 1;
  const double share = smooth_step(0.27, 0.40, std::abs(p.z)) * smooth_step(0.30, 0.40, p.y);
  const double calm = 0.012 * sine(mood.key / 40);
  const double beat = mood.fright * (0.17 + 0.10 * sine(mood.key / 7));
  const Vec3d shoulder{kShoulder.x, kShoulder.y, side * kShoulder.z};
  return turned(p, shoulder, 0, -side * share * (calm + beat));
}

Vec3d step_leg(const Vec3d& p, const Mood& mood) {
  const double share = smooth_step(kHip, 0.10, p.y);
  const double phase = mood.key / 32 + (p.z < 0 ? 0.5 : 0);
  const double gait = 1 - mood.peck;
  const double lift = std::max(sine(phase), 0.0) * 0.09 * gait + 0.10 * mood.fright;
  return p + Vec3d{0.05 * cosine(phase) * gait, lift, 0} * share;
}

Vec3d ooze_eye(const Vec3d& p, const Mood& mood) {
  const double side = p.z < 0 ? -1 : 1;
  const Vec3d center{kEye.x, kEye.y, side * kEye.z};
  const Vec3d out = (p - center) * (1 + 0.55 * mood.fright);
  const double low = std::min(std::max((center.y + kEyeRadius - p.y) / (2 * kEyeRadius), 0.0), 1.0);
  const double drip = mood.ooze * (0.55 + 0.05 * sine(mood.key / 11 + 0.3 * side));
  return center + out +
         Vec3d{0.10 * mood.fright + 0.10 * drip * low, -drip * low * low,
               side * (0.05 * mood.fright + 0.12 * drip * low)};
}

/// The head swells and turns; the neck is drawn out between it and the body.
Vec3d stretch_neck(const Vec3d& p, const Mood& mood) {
  const double front = smooth_step(-0.05, 0.15, p.x);
  const double along = front * smooth_step(kNeckBase.y, kNeckTop.y, p.y);
  const double on_neck = 4 * along * (1 - along);
  Vec3d q = p;
  q = kHead + (q - kHead) * (1 + 0.28 * mood.fright * smooth_step(0.7, 1, along));
  const Vec3d axis = kNeckBase + (kNeckTop - kNeckBase) * along;
  const double thin = 1 - 0.40 * mood.fright * on_neck;
  q.x = axis.x + (q.x - axis.x) * thin;
  q.z = axis.z + (q.z - axis.z) * thin;
  q = turned(q, kHead, 1, along * (mood.look + 0.05 * mood.dizzy * sine(mood.key / 18)));
  q = turned(q, kHead, 2, along * (-0.20 * mood.peck + 0.06 * mood.fright));
  const double sway = mood.dizzy * sine(mood.key / 24);
  const Vec3d reach{0.34 * mood.peck + 0.10 * mood.fright - 0.05 * mood.dizzy,
                    -0.80 * mood.peck + 2.3 * mood.fright - 0.10 * mood.dizzy, 0.22 * sway};
  const double wobble = mood.fright * sine(mood.key / 12 + 0.8 * along);
  const Vec3d bow{0.26 * mood.peck - 0.16 * mood.fright, 0.12 * mood.peck, 0.20 * wobble};
  return q + reach * along + bow * on_neck;
}

Vec3d breathe(const Vec3d& p, const Mood& mood) {
  const double swell = 0.02 * sine(mood.key / 45) - 0.16 * mood.fright + 0.05 * mood.peck;
  const double above = smooth_step(0.05, kHip, p.y);
  const double wide = 1 - 0.5 * swell * above;
  Vec3d q{p.x * wide, p.y - 0.25 * swell * above * std::min(p.y, 0.9), p.z * wide};
  q.y += 0.02 * std::abs(sine(mood.key / 32)) * above + 0.10 * mood.fright * above;
  return turned(q, {0, kHip, 0}, 2, above * (-0.07 * mood.peck + 0.03 * mood.fright));
}

enum class Part { kBody, kEye };

Vec3d posed(const Vec3d& p, Part part, const Mood& mood) {
  Vec3d q = p;
  if (part == Part::kEye) {
    // An eye goes with the head as a whole, whatever hangs out of it.
    const Vec3d center{kEye.x, kEye.y, p.z < 0 ? -kEye.z : kEye.z};
    return breathe(stretch_neck(center, mood), mood) + (ooze_eye(p, mood) - center);
  }
  q = step_leg(flap_wing(ruffle(p, mood), mood), mood);
  return breathe(stretch_neck(q, mood), mood);
}

struct Collected {
  SampleSequence sequence;
  std::vector<Vec3d> rest;
  std::vector<Part> parts;

  void add(const SampleSolid& solid, Part part, ByteColor (*color)(const Vec3d&)) {
    const TriangleMesh mesh = mesh_solid(solid);
    const auto first = static_cast<std::uint32_t>(rest.size());
    for (const auto& [a, b, c] : mesh.triangles)
      sequence.triangles.push_back({a + first, b + first, c + first});
    for (const Vec3d& p : mesh.positions) {
      rest.push_back(p);
      parts.push_back(part);
      sequence.colors.push_back(color(p));
    }
  }
};

}  // namespace

SampleSequence make_chicken() {
  Collected chicken;
  chicken.add(chicken_body(), Part::kBody, chicken_body_color);
  chicken.add(chicken_eye(1), Part::kEye, chicken_eye_color);
  chicken.add(chicken_eye(-1), Part::kEye, chicken_eye_color);
  for (int key = 0; key < kKeys; ++key) {
    const Mood mood = mood_at(key);
    auto& pose = chicken.sequence.poses.emplace_back();
    for (std::size_t i = 0; i < chicken.rest.size(); ++i)
      pose.push_back(posed(chicken.rest[i], chicken.parts[i], mood));
  }
  return std::move(chicken.sequence);
}

}  // namespace mdk
