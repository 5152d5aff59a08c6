// Moved.
#pragma once
#include "common/motion/pose_sequence.h"
