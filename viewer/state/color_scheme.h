// ColorScheme: whether the window is dark or light.
#pragma once

namespace mdk {

enum class ColorScheme { kDark, kLight };

}  // namespace mdk
