// Moved.
#pragma once

#include "preprocess/tool/text.h"
