// PNG and JPEG images, decoded for display.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "common/motion/pose_sequence.h"

namespace mdk::gltf {

struct DecodedImage {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> texels;  ///< sRGB RGBA, 8 bits each, red lowest; row 0 on top
  std::string problem;                ///< why there are no texels; empty where there are
};

/// Decodes a PNG or JPEG of at most 64 megapixels; its size is judged before it is decoded. Never
/// throws for a bad image: see `problem` ("is neither PNG nor JPEG").
DecodedImage decode_image(std::span<const unsigned char> bytes);

/// The number of a new texture of `appearance`; kNoTexture and why in `problem` where the image
/// cannot be decoded or there would be over 268 million texels.
std::uint32_t add_texture(std::span<const unsigned char> bytes, Appearance& appearance,
                          std::string& problem);

}  // namespace mdk::gltf
