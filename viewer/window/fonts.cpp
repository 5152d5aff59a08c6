#include "viewer/window/fonts.h"

#include <array>
#include <filesystem>

namespace mdk {
namespace {

constexpr float kTextSize = 14.5f, kLargeSize = 25;

// The first folder that has the family; where none has, ImGui's built-in font serves.
constexpr std::array kFontFolders = {
    "/usr/share/fonts/truetype/dejavu/",
    "/usr/share/fonts/dejavu-sans-fonts/",
    "/usr/share/fonts/TTF/",
    "/usr/local/share/fonts/dejavu/",
};

// Latin, Greek and Cyrillic, for names in files, and the punctuation of our own sentences.
constexpr std::array<ImWchar, 7> kNameGlyphs = {0x20, 0x17f, 0x370, 0x52f, 0x2010, 0x2027, 0};
// The large font writes figures and words of ours alone. Every glyph is drawn before the first
// frame.
constexpr std::array<ImWchar, 3> kPlainGlyphs = {0x20, 0x7e, 0};

// ImGui 1.86 aborts on a font file that is missing: ask before.
ImFont* load(ImFontAtlas& atlas, const char* file, float pixels, const ImWchar* glyphs) {
  ImFontConfig config;
  config.OversampleH = 2;
  for (const char* folder : kFontFolders) {
    const std::filesystem::path path = std::filesystem::path(folder) / file;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored))
      return atlas.AddFontFromFileTTF(path.c_str(), pixels, &config, glyphs);
  }
  config.SizePixels = pixels;
  return atlas.AddFontDefault(&config);
}

}  // namespace

Fonts load_fonts(ImFontAtlas& atlas, float pixels) {
  constexpr int kCount = 3;
  const bool known = atlas.IsBuilt() && atlas.Fonts.Size == kCount &&
                     atlas.Fonts[0]->ConfigData->SizePixels == kTextSize * pixels;
  if (!known) {
    atlas.Clear();
    load(atlas, "DejaVuSans.ttf", kTextSize * pixels, kNameGlyphs.data());
    load(atlas, "DejaVuSans-Bold.ttf", kTextSize * pixels, kNameGlyphs.data());
    load(atlas, "DejaVuSans.ttf", kLargeSize * pixels, kPlainGlyphs.data());
    unsigned char* texels = nullptr;
    int width = 0, height = 0;
    atlas.GetTexDataAsRGBA32(&texels, &width, &height);  // draws them
  }
  return {atlas.Fonts[0], atlas.Fonts[1], atlas.Fonts[2]};
}

FontBook::FontBook(float pixels) : thread_([this, pixels] { load_fonts(atlas_, pixels); }) {}

FontBook::~FontBook() { atlas(); }

ImFontAtlas& FontBook::atlas() {
  if (thread_.joinable()) thread_.join();
  return atlas_;
}

}  // namespace mdk
