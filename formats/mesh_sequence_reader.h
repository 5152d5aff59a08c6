// Moved.
#pragma once

#include "formats/mesh/reader.h"
