// Moved.
#pragma once
#include "formats/mdk/writer.h"
