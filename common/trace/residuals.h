// Moved.
#pragma once

#include "common/trace/heat_map.h"
