// Moved.
#pragma once

#include "common/math/affine3.h"
