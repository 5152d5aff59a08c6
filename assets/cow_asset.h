// A cow of jelly, dropped on a floor.
#pragma once

#include "assets/sample_sequence.h"

namespace mdk {

/// 204 keys, 30 a second: it falls askew, gives way, topples, is kicked up again and falls once
/// more.
SampleSequence make_cow();

}  // namespace mdk
