// Moved.
#pragma once
#include "common/base/parallel.h"
