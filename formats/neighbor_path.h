// Moved.
#pragma once
#include "formats/files/file_kind.h"
