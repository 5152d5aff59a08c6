// Moved.
#pragma once

#include "preprocess/tool/shared_options.h"
