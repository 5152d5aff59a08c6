// Moved; until its users say so themselves.
#include "common/trace/kernels/beam_kernels.h"
