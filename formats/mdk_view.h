// Moved.
#pragma once
#include "formats/mdk/mdk_file.h"
