// Moved.
#pragma once

#include "tests/commands/sample_model.h"
