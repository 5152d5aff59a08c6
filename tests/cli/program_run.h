// Moved.
#pragma once

#include "tests/commands/program_run.h"
