// Limbs join the trunk, never each other: an arm or a leg is blended into what both sides share,
// and the sides then meet without rounding.
#include "assets/ben_shape.h"

#include <algorithm>
#include <cmath>

namespace mdk {
namespace {

constexpr ByteColor kSkin{226, 172, 138}, kHair{74, 46, 30}, kShirt{214, 62, 48},
    kStripe{248, 240, 226}, kShorts{38, 58, 104}, kShoe{240, 240, 236}, kSole{52, 54, 62},
    kSock{244, 244, 240}, kEyeWhite{250, 250, 248}, kIris{44, 66, 92}, kLips{186, 104, 92};

constexpr Vec3d kEye{0.100, 1.690, 0.034};
constexpr double kSoleTop = 0.022, kSockTop = 0.155, kSockLow = 0.10;
constexpr double kSleeveEnd = 0.62, kShortsEnd = 0.60;  // along upper arm and thigh
constexpr double kStripeLow = 1.285, kStripeHigh = 1.335;

Vec3d mirrored(const Vec3d& p) { return {p.x, p.y, std::abs(p.z)}; }

/// Whether a part that lies within a ball can be nearer than `known`, or round off a seam with it.
bool may_join(const Vec3d& p, const Vec3d& center, double radius, double known) {
  constexpr double kWidestSeam = 0.03;
  return length(p - center) - radius < known + kWidestSeam;
}

/// A tube about a bone from `from` to `to` (shares of its length), open at its far end.
double tube(const Vec3d& p, const Basis& bone, double length, const std::array<double, 2>& radii,
            double end) {
  const Vec3d q = bone.to_local(p);
  const double side = rounded_cone(q, radii[0], radii[1], length);
  return smooth_max(side, q.y - length * end, 0.012);
}

}  // namespace

double BenShape::torso(const Vec3d& p) const {
  const Vec3d q = mirrored(p);
  double d = ellipsoid(p - Vec3d{-0.01, 0.975, 0}, {0.118, 0.125, 0.160});
  const Vec3d waist{p.x, p.y, p.z * 0.80};
  d = smooth_min(d, rounded_cone_between(waist, {0, 1.02, 0}, 0.105, {0, 1.22, 0}, 0.104), 0.09);
  d = smooth_min(d, ellipsoid(p - Vec3d{-0.005, 1.325, 0}, {0.122, 0.185, 0.168}), 0.09);
  d = smooth_min(d, ellipsoid(q - Vec3d{0.062, 1.355, 0.068}, {0.060, 0.070, 0.080}), 0.06);
  d = smooth_min(d, ellipsoid(q - Vec3d{-0.075, 0.925, 0.062}, {0.075, 0.085, 0.075}), 0.05);
  d = smooth_min(
      d, rounded_cone_between(q, {-0.012, 1.470, 0}, 0.075, {-0.005, 1.435, 0.165}, 0.062), 0.07);
  return smooth_min(d, rounded_cone_between(p, {-0.012, 1.45, 0}, 0.066, {0.012, 1.60, 0}, 0.056),
                    0.05);
}

double BenShape::head(const Vec3d& p) const {
  const Vec3d q = mirrored(p);
  double d = ellipsoid(p - Vec3d{0.010, 1.715, 0}, {0.104, 0.110, 0.082});
  d = smooth_min(d, ellipsoid(p - Vec3d{0.050, 1.640, 0}, {0.066, 0.072, 0.060}), 0.05);
  d = smooth_min(d, ellipsoid(p - Vec3d{0.088, 1.596, 0}, {0.022, 0.018, 0.024}), 0.03);  // chin
  d = smooth_min(d, ellipsoid(q - Vec3d{0.094, 1.712, 0.030}, {0.018, 0.012, 0.030}), 0.025);
  d = smooth_max(d, -ellipsoid(q - Vec3d{0.122, 1.690, 0.036}, {0.022, 0.016, 0.022}), 0.02);
  d = smooth_min(d, ellipsoid(q - kEye, {0.0150, 0.0135, 0.0155}), 0.004);
  const double nose = rounded_cone_between(p, {0.106, 1.695, 0}, 0.009, {0.128, 1.656, 0}, 0.0145);
  d = smooth_min(d, nose, 0.015);
  const double lips = ellipsoid(p - Vec3d{0.110, 1.622, 0}, {0.014, 0.0095, 0.025});
  d = smooth_min(d, lips, 0.008);
  const double ear = ellipsoid(q - Vec3d{0.0, 1.685, 0.088}, {0.022, 0.034, 0.011});
  d = smooth_min(d, ear, 0.010);
  return smooth_min(d, hair(p), 0.006);
}

double BenShape::hair(const Vec3d& p) const {
  const double cap = ellipsoid(p - Vec3d{-0.004, 1.735, 0}, {0.114, 0.112, 0.094});
  // Cut off along the brow, then down behind the ears.
  const double brow = 0.55 * (p.x - 0.02) - (p.y - 1.715);
  const double nape = 1.64 - p.y;
  return smooth_max(cap, std::max(brow * 0.85, nape), 0.02);
}

double BenShape::arm(const Vec3d& p, const BenLimbs& limbs) const {
  const Vec3d shoulder = rig_.rest(limbs.upper_arm).origin, elbow = rig_.rest(limbs.forearm).origin;
  const Vec3d wrist = rig_.rest(limbs.hand).origin;
  double d = rounded_cone_between(p, shoulder, 0.058, elbow, 0.042);
  d = smooth_min(d, ellipsoid(p - shoulder, {0.068, 0.070, 0.066}), 0.04);
  const Vec3d biceps = rig_.rest(limbs.upper_arm).to_local(p) - Vec3d{0, 0.155, 0.018};
  d = smooth_min(d, ellipsoid(biceps, {0.040, 0.085, 0.040}), 0.03);
  d = smooth_min(d, rounded_cone_between(p, elbow, 0.042, wrist, 0.029), 0.025);
  const Vec3d muscle = rig_.rest(limbs.forearm).to_local(p) - Vec3d{0, 0.075, 0.004};
  d = smooth_min(d, ellipsoid(muscle, {0.045, 0.085, 0.042}), 0.03);
  if (!may_join(p, rig_.on_bone(limbs.hand, 0.5), 0.13, d)) return d;
  return smooth_min(d, hand(p, limbs), 0.02);
}

/// A loose fist: a palm, four fingers rolled in towards the body, a thumb on the front.
double BenShape::hand(const Vec3d& p, const BenLimbs& limbs) const {
  const Basis& basis = rig_.rest(limbs.hand);
  const double inward = p.z < 0 ? 1 : -1;  // the palm looks to the body
  Vec3d q = basis.to_local(p);
  q.x *= inward;
  double d = ellipsoid(q - Vec3d{0.0, 0.050, 0.0}, {0.022, 0.052, 0.040});
  for (int finger = 0; finger < 4; ++finger) {
    const double z = 0.031 - 0.0205 * finger, reach = finger == 3 ? 0.082 : 0.090;
    const Vec3d knuckle{-0.006, reach, z}, middle{0.020, reach + 0.018, z};
    const Vec3d tip{0.036, reach - 0.014, z};
    double f = rounded_cone_between(q, knuckle, 0.0125, middle, 0.0115);
    f = smooth_min(f, rounded_cone_between(q, middle, 0.0115, tip, 0.0100), 0.006);
    d = smooth_min(d, f, 0.008);
  }
  const double thumb = smooth_min(
      rounded_cone_between(q, {0.006, 0.028, 0.032}, 0.016, {0.022, 0.062, 0.046}, 0.013),
      rounded_cone_between(q, {0.022, 0.062, 0.046}, 0.013, {0.036, 0.084, 0.032}, 0.0105), 0.008);
  return smooth_min(d, thumb, 0.010);
}

double BenShape::leg(const Vec3d& p, const BenLimbs& limbs) const {
  const Basis &thigh = rig_.rest(limbs.thigh), &shin = rig_.rest(limbs.shin);
  const Vec3d hip = thigh.origin, knee = shin.origin, ankle = rig_.rest(limbs.foot).origin;
  double d = rounded_cone_between(p, hip, 0.086, knee, 0.054);
  d = smooth_min(d, ellipsoid(thigh.to_local(p) - Vec3d{0, 0.17, 0.022}, {0.074, 0.175, 0.066}),
                 0.04);
  d = smooth_min(d, rounded_cone_between(p, knee, 0.052, ankle, 0.034), 0.04);
  d = smooth_min(d, ellipsoid(shin.to_local(p) - Vec3d{0, 0.120, -0.022}, {0.048, 0.105, 0.046}),
                 0.035);
  const Vec3d sock_local = shin.to_local(p);
  const double sock = smooth_max(rounded_cone(sock_local, 0.05, 0.040, length(ankle - knee)),
                                 p.y - kSockTop, 0.008);
  d = smooth_min(d, std::max(sock, kSockLow - 0.04 - p.y), 0.008);
  if (!may_join(p, rig_.rest(limbs.foot).origin, 0.25, d)) return d;
  return smooth_min(d, shoe(p, limbs), 0.010);
}

double BenShape::shoe(const Vec3d& p, const BenLimbs& limbs) const {
  const Vec3d ankle = rig_.rest(limbs.foot).origin, ball = rig_.rest(limbs.toes).origin;
  const Vec3d heel{ankle.x - 0.030, 0.042, ankle.z};
  double d = rounded_cone_between(p, heel, 0.043, {ball.x + 0.025, 0.036, ball.z + 0.0}, 0.047);
  d = smooth_min(d,
                 rounded_cone_between(p, {ball.x + 0.01, 0.034, ball.z}, 0.045,
                                      {ball.x + 0.062, 0.030, ball.z}, 0.034),
                 0.03);
  d = smooth_min(d, ellipsoid(p - ankle - Vec3d{0.010, 0.0, 0}, {0.055, 0.052, 0.043}), 0.03);
  // The sole stands out a little and is flat below.
  const Vec3d flat{p.x, p.y * 1.6, p.z};
  const double sole = smooth_max(rounded_cone_between(flat, {heel.x, 0.030, heel.z}, 0.050,
                                                      {ball.x + 0.05, 0.030, ball.z}, 0.049),
                                 p.y - kSoleTop, 0.006);
  return smooth_max(smooth_min(d, sole, 0.004), 0.002 - p.y, 0.010);
}

double BenShape::shirt(const Vec3d& p) const {
  const double body = smooth_max(torso(p) - 0.014, std::max(0.985 - p.y, p.y - 1.495), 0.016);
  const Vec3d neck{p.x + 0.002, p.y - 1.520, p.z};
  const double collar = smooth_max(body, -ellipsoid(neck, {0.070, 0.055, 0.074}), 0.012);
  const int upper_arm = limbs_near(p).upper_arm;
  const double sleeve =
      tube(p, rig_.rest(upper_arm), rig_.joints[static_cast<std::size_t>(upper_arm)].length,
           {0.074, 0.066}, kSleeveEnd);
  return smooth_min(collar, sleeve, 0.045);
}

double BenShape::shorts(const Vec3d& p) const {
  const double seat = smooth_max(torso(p) - 0.012, std::max(0.84 - p.y, p.y - 1.03), 0.016);
  const int thigh = limbs_near(p).thigh;
  const double trouser =
      tube(p, rig_.rest(thigh), rig_.joints[static_cast<std::size_t>(thigh)].length, {0.104, 0.098},
           kShortsEnd);
  return smooth_min(seat, smooth_max(trouser, p.y - 1.0, 0.02), 0.035);
}

double BenShape::distance(const Vec3d& p) const {
  double trunk = torso(p);
  if (may_join(p, {0.01, 1.69, 0}, 0.22, trunk)) trunk = smooth_min(trunk, head(p), 0.02);
  trunk = smooth_min(smooth_min(trunk, shirt(p), 0.008), shorts(p), 0.008);
  double d = trunk;
  for (const BenLimbs& limbs : rig_.sides) {
    if (may_join(p, rig_.rest(limbs.forearm).origin, 0.45, trunk))
      d = std::min(d, smooth_min(trunk, arm(p, limbs), 0.02));
    if (may_join(p, rig_.rest(limbs.shin).origin, 0.58, trunk))
      d = std::min(d, smooth_min(trunk, leg(p, limbs), 0.012));
  }
  return d;
}

double BenShape::seam(const Vec3d& p) const {
  const auto nearest = [](double a, double b) { return std::abs(b) < std::abs(a) ? b : a; };
  double d = nearest(shirt(p) - 0.004, hair(p) - 0.003);
  d = nearest(d, std::max(shorts(p) - 0.004, -(shirt(p) - 0.004)));
  if (p.y < 0.3) d = nearest(nearest(d, p.y - kSockLow), nearest(p.y - kSoleTop, p.y - kSockTop));
  if (p.y > 1.2 && std::abs(p.z) < 0.2 && p.y < 1.45)
    d = nearest(d, nearest(p.y - kStripeLow, p.y - kStripeHigh));
  return d;
}

double BenShape::edge_length(const Vec3d& p) const {
  constexpr double kBody = 0.0185, kFace = 0.0084, kHand = 0.0093, kShoeEdge = 0.0123;
  const auto finer = [](double fine, double share) { return kBody + (fine - kBody) * share; };
  double reach = 1;
  for (const BenLimbs& limbs : rig_.sides)
    reach = std::min(reach, length(p - rig_.on_bone(limbs.hand, 0.5)));
  return std::min({finer(kFace, smooth_step(1.55, 1.62, p.y) * smooth_step(0.0, 0.06, p.x)),
                   finer(0.0115, smooth_step(1.50, 1.60, p.y)),
                   finer(kHand, smooth_step(0.18, 0.09, reach)),
                   finer(kShoeEdge, smooth_step(0.20, 0.10, p.y))});
}

ByteColor BenShape::color(const Vec3d& p) const {
  const Vec3d q = mirrored(p);
  if (p.y > 1.5) {
    if (p.x > 0.09 && ellipsoid(q - kEye, {0.0165, 0.015, 0.0165}) < 0) {
      const Vec3d pupil = kEye + Vec3d{0.016, 0.0, -0.001};
      return length(q - pupil) < 0.0085 ? kIris : kEyeWhite;
    }
    if (ellipsoid(p - Vec3d{0.112, 1.622, 0}, {0.016, 0.0100, 0.025}) < 0) return kLips;
    if (hair(p) < 0.003) return kHair;
  }
  if (p.y < kSockTop + 0.001) {
    if (p.y < kSoleTop + 0.001) return kSole;
    return p.y < kSockLow ? kShoe : kSock;
  }
  if (shirt(p) < 0.004) {
    const bool stripe = p.y > kStripeLow && p.y < kStripeHigh && torso(p) < 0.02;
    return stripe ? kStripe : kShirt;
  }
  return shorts(p) < 0.004 ? kShorts : kSkin;
}

}  // namespace mdk
