// Moved.
#pragma once
#include "formats/files/mapped_file.h"
