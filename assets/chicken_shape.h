// The chicken at rest, and what each point of it belongs to.
#pragma once

#include "assets/sample_sequence.h"

namespace mdk {

// Metres; it looks to +x and stands on y = 0. What has two sides is given for +z.
inline constexpr Vec3d kNeckBase{0.27, 0.78, 0}, kNeckTop{0.40, 1.12, 0};
inline constexpr Vec3d kHead{0.44, 1.27, 0}, kEye{0.555, 1.345, 0.085};
inline constexpr Vec3d kShoulder{0.08, 0.68, 0.27};
inline constexpr double kEyeRadius = 0.085, kHip = 0.34;

/// All but the eyes, one closed solid.
SampleSolid chicken_body();
ByteColor chicken_body_color(const Vec3d& p);

/// The eye on the side of `sign`, +1 or -1.
SampleSolid chicken_eye(double sign);
ByteColor chicken_eye_color(const Vec3d& p);

}  // namespace mdk
