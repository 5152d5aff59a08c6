// A model's lists, each in a block of memory of its own: where AddressSanitizer sees one step
// outside.
#pragma once

#include "common/motion/model.h"

namespace mdk::test {

ModelStorage copy_of(const Model& model);

}  // namespace mdk::test
