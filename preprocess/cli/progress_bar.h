// Moved.
#pragma once

#include "preprocess/tool/progress_bar.h"
