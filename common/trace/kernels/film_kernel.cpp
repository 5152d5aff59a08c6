#include "common/trace/kernels/film_kernel.h"

#include <algorithm>

#include "common/trace/color.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/trace/kernels/film_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// after highway.h
#include "common/simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace mdk {
namespace HWY_NAMESPACE {
namespace films {

using ByteTag = hn::RebindToSigned<FloatTag>;  ///< a byte in each lane

/// As srgb_from_linear(), lane by lane.
HWY_INLINE hn::Vec<ByteTag> srgb_bytes(const std::uint8_t* table, const float* linear) {
  const FloatTag d;
  const ByteTag di;
  const auto value = hn::Load(d, linear);
  const auto clamped =
      hn::IfThenElseZero(hn::Gt(value, hn::Zero(d)), hn::Min(value, hn::Set(d, 1.0f)));
  const auto step =
      hn::ConvertTo(di, hn::Add(hn::Mul(clamped, hn::Set(d, kLastSrgbStep)), hn::Set(d, 0.5f)));
  const auto* bytes = reinterpret_cast<const std::int32_t*>(table);
  return hn::And(hn::GatherOffset(di, bytes, step), hn::Set(di, 255));
}

void Develop(const TileColors& colors, const std::uint32_t* background, std::uint32_t columns,
             std::uint32_t rows, std::uint32_t* pixels, std::size_t stride) {
  const ByteTag di;
  const hn::RebindToUnsigned<ByteTag> du;
  const std::uint8_t* table = srgb_table().data();
  // All of the tile before any of it goes out: fetches from a table of 4 KB wait for stores under
  // way, whose addresses agree with one of theirs in the lowest 12 bits.
  alignas(64) std::uint32_t tile[kTilePixels];
  for (std::uint32_t at = 0; at < rows * kTileSide; at += hn::Lanes(di)) {
    const auto red = srgb_bytes(table, colors.red + at);
    const auto green = srgb_bytes(table, colors.green + at);
    const auto blue = srgb_bytes(table, colors.blue + at);
    const auto rgb = hn::Or(hn::Or(red, hn::ShiftLeft<8>(green)), hn::ShiftLeft<16>(blue));
    auto pixel = hn::Or(hn::BitCast(du, rgb), hn::Set(du, 0xff000000u));
    if (colors.triangle != nullptr) {
      const auto miss = hn::Eq(hn::Load(du, colors.triangle + at), hn::Set(du, kNoHit));
      pixel = hn::IfThenElse(miss, hn::Set(du, background[at / kTileSide]), pixel);
    }
    hn::Store(pixel, du, tile + at);
  }
  for (std::uint32_t row = 0; row < rows; ++row, pixels += stride)
    std::copy_n(tile + row * kTileSide, columns, pixels);
}

}  // namespace films
using films::Develop;
}  // namespace HWY_NAMESPACE
}  // namespace mdk
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace mdk {

HWY_EXPORT(Develop);

void develop_tile(const TileColors& colors, const std::uint32_t* background, std::uint32_t columns,
                  std::uint32_t rows, std::uint32_t* pixels, std::size_t stride) {
  HWY_DYNAMIC_DISPATCH(Develop)(colors, background, columns, rows, pixels, stride);
}

}  // namespace mdk
#endif  // HWY_ONCE
