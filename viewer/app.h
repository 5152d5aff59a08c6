// Moved.
#pragma once

#include "viewer/app/app.h"  // IWYU pragma: export
