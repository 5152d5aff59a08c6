// Moved.
#pragma once
#include "formats/files/text.h"
