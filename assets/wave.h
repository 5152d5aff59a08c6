// Sine waves from + - * / alone, which every IEEE machine rounds alike: the same bits everywhere.
#pragma once

#include <cmath>

namespace mdk {

/// sin(2 pi turns), to about 1e-11.
inline double sine(double turns) {
  double t = turns - std::floor(turns + 0.5);
  if (t > 0.25) t = 0.5 - t;
  if (t < -0.25) t = -0.5 - t;
  const double x = 6.283185307179586 * t, q = x * x;
  double sum = 1;  // x - x^3/3! + x^5/5! - ..., from its far end
  for (int n = 17; n >= 3; n -= 2) sum = 1 - sum * q / (n * (n - 1));
  return x * sum;
}

inline double cosine(double turns) { return sine(turns + 0.25); }

}  // namespace mdk
