#include "viewer/panel/number_text.h"

#include "common/base/figure_text.h"

namespace mdk {

std::string short_number(double value) {
  return fixed_text(value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0);
}

std::string milliseconds_text(double ms) { return short_number(ms) + " ms"; }

std::string rate_text(double per_second) {
  if (per_second >= 1e9) return fixed_text(per_second / 1e9, 2) + " G";
  if (per_second >= 1e6) return fixed_text(per_second / 1e6, per_second < 1e8 ? 1 : 0) + " M";
  if (per_second >= 1e3) return fixed_text(per_second / 1e3, 0) + " k";
  return fixed_text(per_second, 0);
}

}  // namespace mdk
