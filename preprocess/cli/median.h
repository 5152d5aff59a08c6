// Moved.
#pragma once

#include "preprocess/tool/measures.h"
