// Moved.
#pragma once
#include "formats/files/atomic_file.h"
