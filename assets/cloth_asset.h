// A cloth that no decomposition helps: everything bends, everywhere, all the time.
#pragma once

#include "assets/sample_sequence.h"

namespace mdk {

/// 100 keys, 30 a second: a checked cloth falls from its two upper corners and is shaken out in
/// gusts of wind.
SampleSequence make_cloth();

}  // namespace mdk
