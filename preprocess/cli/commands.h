// Moved.
#pragma once

#include "preprocess/commands/command_line.h"
