// Fonts of the panel, their glyphs drawn on a thread of its own while a window opens.
#pragma once

#include <imgui.h>

#include <thread>

namespace mdk {

struct Fonts {
  ImFont* text = nullptr;
  ImFont* strong = nullptr;
  ImFont* large = nullptr;
};

/// The fonts in `atlas`, in place of those there are, unless these are those already; whole
/// and drawn. `pixels`: framebuffer pixels per unit of design. Cost: some 20 ms where they are new.
Fonts load_fonts(ImFontAtlas& atlas, float pixels);

/// The atlas of a window that is not there yet. Must outlive it.
class FontBook {
 public:
  explicit FontBook(float pixels);
  ~FontBook();
  FontBook(const FontBook&) = delete;
  FontBook& operator=(const FontBook&) = delete;

  /// Waits until all is drawn.
  ImFontAtlas& atlas();

 private:
  ImFontAtlas atlas_;
  std::thread thread_;
};

}  // namespace mdk
