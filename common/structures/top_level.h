// Moved.
#pragma once

#include "common/structures/wide_bvh.h"
