// Moved.
#pragma once

#include "preprocess/tool/failure.h"
