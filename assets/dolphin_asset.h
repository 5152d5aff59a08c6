// A dolphin of springs that swims by bending itself against the water.
#pragma once

#include "assets/sample_sequence.h"

namespace mdk {

/// 101 keys, 30 a second: it sets off, beats its tail and turns to one side.
SampleSequence make_dolphin();

}  // namespace mdk
