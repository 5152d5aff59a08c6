// A cartoon chicken that gets the fright of its life.
#pragma once

#include "assets/sample_sequence.h"

namespace mdk {

/// 400 keys, 30 a second: it pecks, listens, and around key 250 its neck shoots up to several times
/// its length while its feathers stand up and its eyes ooze out; the rest is calm. The body and the
/// eyes are loose parts.
SampleSequence make_chicken();

}  // namespace mdk
