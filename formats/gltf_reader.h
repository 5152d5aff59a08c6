// Moved.
#pragma once

#include "formats/gltf/reader.h"
