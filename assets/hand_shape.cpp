// Bones wrapped in capsules, then muscles, webs and tendons, each joined smoothly to what is there.
// A digit joins the palm but never another digit, so fingers stay apart however near they are.
#include "assets/hand_shape.h"

namespace mdk {
namespace {

// Where the long bones of the palm begin, index to little finger.
constexpr std::array<Vec3d, 4> kCarpals = {
    {{1.25, 1.5, -0.15}, {0.40, 1.5, -0.25}, {-0.45, 1.45, -0.15}, {-1.15, 1.3, 0.05}}};

// The sleeve: an oval tube about the arm that opens at its top, with a band sewn on.
constexpr double kSleeveEnd = -8.6, kRim = -3.2, kRimFloor = -3.75, kBand = -4.35;

}  // namespace

HandShape::HandShape(const HandSkeleton& skeleton) {
  for (int d = 0; d < kDigits; ++d) digits_.emplace_back(skeleton, d);
}

Aabbd HandShape::bounds() const { return {{-6.5, -9.6, -4.2}, {8.5, 20.6, 5.0}}; }

double HandShape::distance(const Vec3d& p) const {
  const double base = palm(p);
  double d = base;
  for (std::size_t i = 0; i < digits_.size(); ++i)
    d = std::min(d, smooth_min(base, digits_[i].distance(p), i == 0 ? 0.9 : 0.6));
  return smooth_min(d, sleeve(p), 0.35);
}

double HandShape::palm(const Vec3d& p) const {
  double d = arm(p);
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3d head = digits_[i + 1].basis(0).origin;
    const double r = digits_[i + 1].radius(0);
    d = smooth_min(d, rounded_cone_between(p, kCarpals[i], 1.12, head, r * 1.0), 1.3);
  }
  d = muscles(d, p);
  d = webs(d, p);
  return tendons(d, p);
}

double HandShape::arm(const Vec3d& p) const {
  constexpr double kDepth = 0.72, kElbow = -8.0;
  const Vec3d q{p.x, p.y - kElbow, p.z / kDepth};
  const double forearm = kDepth * 1.12 * rounded_cone(q, 2.9, 2.42, 0.6 - kElbow);
  const double ulna = ellipsoid(p - Vec3d{-1.72, -1.1, -0.85}, {0.95, 1.15, 0.85});
  // The arm ends within the sleeve.
  return smooth_max(smooth_min(forearm, ulna, 0.8), kElbow - p.y, 0.5);
}

double HandShape::muscles(double d, const Vec3d& p) const {
  const DigitShape& thumb = digits_[0];
  const Basis& cmc = thumb.basis(0);
  // The ball of the thumb, and its counterpart below the little finger.
  const Vec3d ball = cmc.to_local(p) - Vec3d{-0.15, 1.75, 0.15};
  d = smooth_min(d, ellipsoid(ball, {1.45, 2.5, 1.30}), 1.0);
  const Basis heel = basis_along({-2.0, 3.6, 0.55}, {-0.35, 1, 0}, {0, 0, 1});
  d = smooth_min(d, ellipsoid(heel.to_local(p), {1.15, 2.9, 1.15}), 0.9);
  // The pads below the fingers.
  for (std::size_t i = 1; i < digits_.size(); ++i) {
    const Vec3d pad = digits_[i].basis(0).to_local(p) - Vec3d{0, -0.30, 0.34};
    d = smooth_min(d, ellipsoid(pad, {1.00, 1.15, 0.80}), 0.8);
  }
  // The hollow of the hand.
  const Basis hollow = basis_along({-0.25, 4.9, 2.35}, {-0.25, 1, 0}, {0, 0, 1});
  d = smooth_max(d, -ellipsoid(hollow.to_local(p), {1.35, 2.9, 1.20}), 1.3);
  return d;
}

double HandShape::webs(double d, const Vec3d& p) const {
  for (std::size_t i = 1; i + 1 < digits_.size(); ++i) {
    const Vec3d a = digits_[i].on_bone(0, 0.36), b = digits_[i + 1].on_bone(0, 0.40);
    const Vec3d knuckles = (digits_[i].basis(0).origin + digits_[i + 1].basis(0).origin) * 0.5;
    const Vec3d edge = (a + b) * 0.5 + Vec3d{0, 0, 0.12};
    d = smooth_min(d, rounded_cone_between(p, knuckles, 0.80, edge, 0.42), 0.5);
  }
  // The fold between thumb and index finger.
  const Vec3d from = digits_[0].on_bone(0, 0.45), to = digits_[0].on_bone(0, 0.86);
  const Vec3d index = kCarpals[0] + (digits_[1].basis(0).origin - kCarpals[0]) * 0.62;
  const double low = rounded_cone_between(p, (from + index) * 0.5, 0.95, (to + index) * 0.5, 0.55);
  return smooth_min(d, low, 1.6);
}

double HandShape::tendons(double d, const Vec3d& p) const {
  for (std::size_t i = 1; i < digits_.size(); ++i) {
    const Basis& mcp = digits_[i].basis(0);
    const double r = digits_[i].radius(0);
    const Vec3d bump = mcp.to_local(p) - Vec3d{0, 0.05, -0.30 * r};
    d = smooth_min(d, ellipsoid(bump, {0.80 * r, 0.95 * r, 0.86 * r}), 0.35);
    const Vec3d start{0.25 * mcp.origin.x, 2.6, -1.18};
    const Vec3d end = mcp.to_world({0, -0.5, -0.86 * r});
    d = smooth_min(d, rounded_cone_between(p, start, 0.12, end, 0.16), 0.7);
  }
  return d;
}

double HandShape::sleeve(const Vec3d& p) const {
  constexpr double kDepth = 0.80, kCloth = 0.52, kTopWidth = 3.52, kFlare = 0.09;
  const double z = p.z / kDepth;
  const double width = kTopWidth + kFlare * (kRim - p.y);
  const double seam = 0.07 * smooth_step(0.22, 0.0, std::abs(p.y - kBand));
  const double side = (std::sqrt(p.x * p.x + z * z) - width) * 0.9 + seam;
  const double solid = smooth_max(side, std::max(kSleeveEnd - p.y, p.y - kRim), 0.6);
  const double room = smooth_max(side + kCloth, kRimFloor - p.y, 0.3);
  return smooth_max(solid, -room, 0.45);
}

HandPart HandShape::part(const Vec3d& p) const {
  constexpr double kOnSurface = 0.05;
  if (sleeve(p) < kOnSurface) return p.y < kBand + 0.02 ? HandPart::kSleeve : HandPart::kBand;
  for (const DigitShape& digit : digits_)
    if (digit.on_nail(p)) return HandPart::kNail;
  return HandPart::kSkin;
}

double HandShape::seam(const Vec3d& p) const {
  double nearest = p.y - kBand;
  for (const DigitShape& digit : digits_) {
    const double outline = digit.nail_outline(p);
    if (length(p - digit.nail_center()) < 1.5 && std::abs(outline) < std::abs(nearest))
      nearest = outline;
  }
  return nearest;
}

double HandShape::edge_length(const Vec3d& p) const {
  constexpr double kCoarse = 0.43, kFinger = 0.275, kCloth = 0.19, kNail = 0.135;
  const auto between = [&](double fine, double t) { return kCoarse + (fine - kCoarse) * t; };
  const double rims =
      smooth_step(kBand - 0.7, kBand - 0.3, p.y) * smooth_step(kRim + 0.8, kRim + 0.2, p.y) +
      0.7 * smooth_step(kSleeveEnd + 1.2, kSleeveEnd + 0.6, p.y);
  double len = std::min({between(kFinger, smooth_step(6.5, 9.5, p.y)),
                         between(kFinger, smooth_step(3.2, 4.5, p.x)), between(kCloth, rims)});
  for (const DigitShape& digit : digits_) {
    const double away = length(p - digit.nail_center());
    len = std::min(len, kNail + (kCoarse - kNail) * 0.5 *
                                    (smooth_step(0.5, 1.5, away) + smooth_step(2, 4, away)));
  }
  return len;
}

}  // namespace mdk
