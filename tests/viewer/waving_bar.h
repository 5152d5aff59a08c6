// A small animated model for the viewer's tests, decomposed as a real one is.
#pragma once

#include <cstdint>

#include "common/motion/model.h"

namespace mdk::test {

/// A bar whose upper half waves: clip "wave" of 11 keys over 1 s, clip "nod" of 5 keys over 0.4 s.
/// `rings`: odd, at least 3; eight triangles between two.
ModelStorage waving_bar(std::uint32_t rings = 9);

}  // namespace mdk::test
