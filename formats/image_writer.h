// Moved.
#pragma once
#include "formats/files/image_writer.h"
