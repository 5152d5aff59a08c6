// Moved.
#pragma once

#include "viewer/state/settings.h"  // IWYU pragma: export
