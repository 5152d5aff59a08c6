// Moved.
#pragma once

#include "formats/assimp/reader.h"
