#include "assets/hand_colors.h"

#include <cmath>

namespace mdk {
namespace {

/// sRGB, each channel in [0, 255].
using Color = Vec3d;

constexpr Color kBack{224, 172, 142}, kPalm{236, 188, 164}, kFlush{208, 120, 104};
constexpr Color kNail{240, 200, 188}, kNailEdge{250, 238, 228};
constexpr Color kBand{244, 242, 236}, kSleeve{52, 82, 128};

Color mix(const Color& a, const Color& b, double t) { return a + (b - a) * t; }

/// 1 in the open, less where the surface closes in within a few millimetres.
double openness(const HandShape& shape, const Vec3d& p, const Vec3d& normal) {
  double shut = 0;
  for (const double reach : {0.15, 0.35, 0.7})
    shut += std::max(0.0, 1 - shape.distance(p + normal * reach) / reach) / 3;
  return 1 - shut;
}

/// How much blood shows: at fingertips, on the backs of the joints, at the pads of the palm.
double flush(const HandShape& shape, const Vec3d& p) {
  double sum = 0;
  for (const DigitShape& digit : shape.digits()) {
    const auto near = [&](const Vec3d& spot, double reach) {
      return smooth_step(reach, 0, length(p - spot));
    };
    sum += 0.75 * near(digit.basis(2).to_world({0, digit.bone_length(2) * 0.8, 0.35}), 1.35);
    for (std::size_t i = 0; i < kPhalanges; ++i) {
      const double r = digit.radius(i);
      sum += (i == 0 ? 0.55 : 0.60) * near(digit.basis(i).to_world({0, 0, -r}), 1.25 * r);
    }
    sum += 0.30 * near(digit.basis(0).to_world({0, -0.2, 1.4}), 1.3);
  }
  return std::min(sum, 0.85);
}

Color skin(const HandShape& shape, const Vec3d& p, const Vec3d& normal) {
  const Color base = mix(kBack, kPalm, smooth_step(-0.4, 0.7, normal.z));
  return mix(base, kFlush, 0.75 * flush(shape, p));
}

Color nail(const HandShape& shape, const Vec3d& p) {
  double along = 0, nearest = 1e9;
  for (const DigitShape& digit : shape.digits()) {
    const double away = length(p - digit.nail_center());
    if (away >= nearest) continue;
    nearest = away;
    along = digit.along_nail(p);
  }
  return mix(kNail, kNailEdge, smooth_step(0.78, 0.9, along));
}

Color color_of(const HandShape& shape, const Vec3d& p, const Vec3d& normal) {
  switch (shape.part(p)) {
    case HandPart::kNail:
      return nail(shape, p);
    case HandPart::kBand:
      return kBand;
    case HandPart::kSleeve:
      return kSleeve;
    case HandPart::kSkin:
      break;
  }
  return skin(shape, p, normal);
}

std::uint8_t linear_from_srgb(double v) {
  const double s = v / 255;
  const double linear = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return static_cast<std::uint8_t>(std::lround(std::min(std::max(linear, 0.0), 1.0) * 255));
}

}  // namespace

std::array<std::uint8_t, 4> surface_color(const HandShape& shape, const Vec3d& p,
                                          const Vec3d& normal) {
  const double shut = 1 - openness(shape, p, normal);
  const HandPart part = shape.part(p);
  const bool is_cloth = part == HandPart::kBand || part == HandPart::kSleeve;
  // Light that has gone through skin leaves folds warm rather than grey.
  const Color loss = is_cloth ? Color{0.12, 0.12, 0.12} : Color{0.30, 0.48, 0.52};
  const Color c = color_of(shape, p, normal);
  return {linear_from_srgb(c.x * (1 - loss.x * shut)), linear_from_srgb(c.y * (1 - loss.y * shut)),
          linear_from_srgb(c.z * (1 - loss.z * shut)), 255};
}

}  // namespace mdk
