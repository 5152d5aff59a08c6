// Moved.
#pragma once
#include "common/base/text.h"
