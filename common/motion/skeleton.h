// Moved.
#pragma once
#include "common/motion/rig.h"
