// PictureName: how saved pictures are called.
#pragma once

#include <string>

namespace mdk {

/// "hand-0001.png", or the first number that is free in the present folder. Throws Error (kIo)
/// where none is.
std::string free_picture_name(const std::string& stem);

}  // namespace mdk
