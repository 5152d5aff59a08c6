// Moved.
#pragma once

#include "tests/commands/baked_sample.h"
