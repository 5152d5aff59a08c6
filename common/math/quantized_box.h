// Moved.
#pragma once

#include "common/math/aabb.h"
