// What libFuzzer calls; one program for each target (MDK_FUZZ_TARGET names its function).
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/fuzz_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mdk::test::feed(mdk::test::MDK_FUZZ_TARGET(), {data, size});
  return 0;
}
