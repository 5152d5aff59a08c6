// Moved.
#pragma once
#include "formats/mdk/layout.h"
#include "formats/files/mapped_file.h"
