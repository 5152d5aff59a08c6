// Moved.
#pragma once

#include "common/structures/kd_tree.h"
