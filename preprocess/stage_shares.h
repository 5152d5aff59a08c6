// Forwards to its new place.
#pragma once
#include "preprocess/pipeline.h"
