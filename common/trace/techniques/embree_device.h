// What both uses of Embree share. Included by Embree's .cpp files alone.
#pragma once

#include <embree3/rtcore.h>

#include <string>
#include <string_view>

#include "common/base/error.h"
#include "common/base/isa.h"

namespace mdk {

/// Vectors as wide as our own kernels may use, and no wider; left alone, Embree keeps to narrow
/// ones on machines whose clock wide ones slowed down once. Threads are those of oneTBB, which both
/// share.
inline std::string embree_device_config() {
  const std::string_view isa = isa_in_use();
  if (isa == "sse4" || isa == "scalar") return "isa=sse4.2";
  if (isa == "avx2") return "isa=avx2,frequency_level=simd256";
  return "frequency_level=simd512";
}

inline void require_embree_success(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    throw Error(ErrorCode::kOverLimit, "Embree is out of memory for this model");
  throw Error(ErrorCode::kInternal, "Embree fails with its error " + std::to_string(error));
}

}  // namespace mdk
