// TextureBlit: shows a picture made on the CPU in a rectangle of the window.
#pragma once

#include <cstdint>
#include <span>

namespace mdk {

/// In framebuffer pixels, from the upper left corner.
struct PixelRect {
  int x = 0, y = 0, width = 0, height = 0;
};

/// The largest rectangle of the picture's shape that fits into `space`, centred.
PixelRect letterbox(const PixelRect& space, std::uint32_t picture_width,
                    std::uint32_t picture_height);

/// Needs a current OpenGL 3.3 context from its making to its end.
class TextureBlit {
 public:
  TextureBlit();
  ~TextureBlit();
  TextureBlit(const TextureBlit&) = delete;
  TextureBlit& operator=(const TextureBlit&) = delete;

  /// `pixels`: width * height sRGB RGBA, row 0 on top.
  void upload(std::span<const std::uint32_t> pixels, std::uint32_t width, std::uint32_t height);

  /// Draws the last upload, filtered, undistorted, inside `space`; texel for pixel where sizes
  /// agree.
  void draw(const PixelRect& space, int framebuffer_height) const;

  void clear() { width_ = height_ = 0; }

 private:
  unsigned program_ = 0, vertex_array_ = 0, texture_ = 0;
  std::uint32_t width_ = 0, height_ = 0;
};

}  // namespace mdk
