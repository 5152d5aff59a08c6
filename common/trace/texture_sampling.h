// Moved.
#pragma once

#include "common/trace/color.h"
