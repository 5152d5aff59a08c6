// Moved.
#pragma once

#include "tests/commands/sample_mesh.h"
