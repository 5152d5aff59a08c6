#include "assets/chicken_shape.h"

#include <algorithm>
#include <cmath>

namespace mdk {
namespace {

constexpr ByteColor kFeather{250, 240, 214}, kWingTip{226, 176, 106}, kTail{150, 84, 48},
    kRed{206, 38, 34}, kBeak{246, 168, 36}, kLeg{232, 142, 30}, kWhite{252, 252, 248},
    kPupil{18, 16, 22};

Vec3d mirrored(const Vec3d& p) { return {p.x, p.y, std::abs(p.z)}; }

double torso(const Vec3d& p) {
  double d = ellipsoid(p - Vec3d{0, 0.60, 0}, {0.42, 0.34, 0.31});
  d = smooth_min(d, ellipsoid(p - Vec3d{0.20, 0.62, 0}, {0.25, 0.28, 0.25}), 0.15);
  return smooth_min(d, ellipsoid(p - Vec3d{-0.32, 0.74, 0}, {0.20, 0.17, 0.15}), 0.15);
}

double tail(const Vec3d& p) {
  const Vec3d root{-0.38, 0.78, 0};
  double d = rounded_cone_between(p, root, 0.075, {-0.66, 1.12, 0}, 0.055);
  d = std::min(d, rounded_cone_between(p, root, 0.075, {-0.78, 0.98, 0}, 0.05));
  return std::min(d, rounded_cone_between(p, root, 0.075, {-0.80, 0.80, 0}, 0.045));
}

double wing(const Vec3d& p) {
  const Basis basis = basis_along(kShoulder, {-1, -0.28, 0.05}, {0, 0, 1});
  const Vec3d q = basis.to_local(mirrored(p)) - Vec3d{0, 0.16, 0.03};
  return ellipsoid(q, {0.16, 0.27, 0.06});
}

double neck_and_head(const Vec3d& p) {
  const double neck = rounded_cone_between(p, {0.22, 0.70, 0}, 0.175, kNeckTop, 0.115);
  return smooth_min(neck, ellipsoid(p - kHead, {0.18, 0.17, 0.155}), 0.08);
}

double comb(const Vec3d& p) {
  double d = ellipsoid(p - Vec3d{0.53, 1.465, 0}, {0.055, 0.075, 0.032});
  d = smooth_min(d, ellipsoid(p - Vec3d{0.44, 1.485, 0}, {0.06, 0.095, 0.034}), 0.03);
  d = smooth_min(d, ellipsoid(p - Vec3d{0.345, 1.445, 0}, {0.055, 0.075, 0.032}), 0.03);
  return std::min(d, ellipsoid(p - Vec3d{0.60, 1.085, 0}, {0.04, 0.075, 0.034}));  // and wattle
}

double beak(const Vec3d& p) {
  return rounded_cone_between({p.x, p.y, 0.85 * p.z}, {0.58, 1.245, 0}, 0.072, {0.74, 1.205, 0},
                              0.018);
}

double legs(const Vec3d& p) {
  const Vec3d q = mirrored(p);
  const Vec3d foot{0.02, 0.035, 0.14};
  double d = rounded_cone_between(q, {0, 0.34, 0.13}, 0.055, {0, 0.06, 0.14}, 0.034);
  for (const Vec3d& toe :
       {Vec3d{0.19, 0.03, 0.05}, Vec3d{0.20, 0.03, 0.20}, Vec3d{-0.11, 0.03, 0.14}})
    d = smooth_min(d, rounded_cone_between(q, foot, 0.032, toe, 0.024), 0.02);
  return d;
}

double body(const Vec3d& p) {
  double d = smooth_min(torso(p), neck_and_head(p), 0.16);
  d = smooth_min(d, tail(p), 0.06);
  d = smooth_min(d, wing(p), 0.03);
  d = smooth_min(d, comb(p), 0.02);
  d = smooth_min(d, beak(p), 0.02);
  return smooth_min(d, legs(p), 0.06);
}

double seam(const Vec3d& p) {
  double nearest = beak(p) - 0.012;
  for (const double d : {comb(p) - 0.012, legs(p) - 0.012, tail(p) - 0.02})
    if (std::abs(d) < std::abs(nearest)) nearest = d;
  return nearest;
}

}  // namespace

SampleSolid chicken_body() {
  return {body, seam, {{-0.92, -0.04, -0.48}, {0.80, 1.62, 0.48}}, 0.022, [](const Vec3d& p) {
            const double thin = std::max({smooth_step(0.38, 0.28, p.y), smooth_step(0.9, 1.15, p.y),
                                          smooth_step(-0.35, -0.5, p.x)});
            return 0.0508 - 0.0197 * thin;
          }};
}

ByteColor chicken_body_color(const Vec3d& p) {
  if (beak(p) < 0.012) return kBeak;
  if (comb(p) < 0.012) return kRed;
  if (legs(p) < 0.012) return kLeg;
  if (tail(p) < 0.02) return kTail;
  if (wing(p) < 0.012 && p.x < -0.12) return kWingTip;
  return kFeather;
}

SampleSolid chicken_eye(double sign) {
  const Vec3d center{kEye.x, kEye.y, kEye.z * sign};
  const double reach = kEyeRadius + 0.02;
  return {[center](const Vec3d& p) { return length(p - center) - kEyeRadius; },
          [](const Vec3d& p) {
            return length(mirrored(p) - kEye - Vec3d{0.075, 0.0, 0.02}) - 0.045;
          },
          {center - Vec3d{reach, reach, reach}, center + Vec3d{reach, reach, reach}},
          0.012,
          [](const Vec3d&) { return 0.021; }};
}

ByteColor chicken_eye_color(const Vec3d& p) {
  return length(mirrored(p) - kEye - Vec3d{0.075, 0.0, 0.02}) < 0.046 ? kPupil : kWhite;
}

}  // namespace mdk
