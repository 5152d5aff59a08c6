// Moved.
#pragma once

#include "common/trace/renderer.h"
