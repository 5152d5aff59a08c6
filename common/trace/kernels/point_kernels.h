// Moved; until its users say so themselves.
#include "preprocess/simd/point_kernels.h"
