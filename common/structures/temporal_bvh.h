// Moved.
#pragma once

#include "common/structures/bvh.h"
