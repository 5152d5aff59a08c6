// Moved.
#pragma once

#include "preprocess/tool/files.h"
