// Forwards to its new place.
#pragma once
#include "preprocess/boxes/cost.h"
