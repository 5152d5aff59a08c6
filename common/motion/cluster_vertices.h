// Moved.
#pragma once
#include "common/motion/posed_mesh.h"
