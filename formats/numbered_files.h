// Moved.
#pragma once

#include "formats/mesh/numbered_files.h"
