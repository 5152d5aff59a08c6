//   .pc2  "POINTCACHE2\0" | i32 version 1 | i32 points | f32 start | f32 rate | i32 frames | f32
//   xyz ... .mdd  i32 frames | i32 points | f32 seconds, per frame | f32 xyz ...
#include "formats/mesh/point_cache.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>

#include "common/base/error.h"
#include "common/base/parallel.h"
#include "formats/files/byte_order.h"
#include "formats/files/mapped_file.h"

namespace mdk {
namespace {

using ByteSpan = std::span<const std::byte>;

constexpr std::string_view kPc2Magic("POINTCACHE2\0", 12);
constexpr std::size_t kPc2HeaderBytes = 32, kMddHeaderBytes = 8;
constexpr std::size_t kPointBytes = 12;
constexpr std::uint64_t kMaxPositionBytes = std::uint64_t{16} << 30;
constexpr std::size_t kFramesPerReport = 64;

template <class Number>
Number number_at(ByteSpan bytes, std::size_t at, std::endian order) {
  return load<Number>(&bytes[at], order);
}

/// What the header says, and where the coordinates start.
struct Layout {
  std::endian order = std::endian::little;
  std::uint32_t points = 0, frames = 0;
  std::size_t first_point = 0;
  std::vector<double> key_times;
};

/// `per_frame`: bytes that each frame takes, apart from its points.
void check_extent(const std::string& path, const Layout& layout, ByteSpan bytes,
                  std::uint32_t vertex_count, std::size_t per_frame) {
  if (layout.points == 0 || layout.frames == 0) throw bad_input(path, "has no frames or no points");
  if (layout.points != vertex_count)
    throw bad_input(path, "moves " + std::to_string(layout.points) + " points, but the mesh has " +
                              std::to_string(vertex_count) +
                              " vertices; give the mesh it was made for");
  // 32-bit counts: no product here can overflow 64 bits.
  const std::uint64_t frame_bytes = std::uint64_t{layout.points} * kPointBytes + per_frame;
  const std::uint64_t whole = (bytes.size() - layout.first_point) / frame_bytes;
  if (whole < layout.frames)
    throw bad_input(path, "is cut short: it has " + std::to_string(whole) + " of its " +
                              std::to_string(layout.frames) + " frames");
  if (std::uint64_t{layout.points} * kPointBytes > kMaxPositionBytes / layout.frames)
    throw Error(ErrorCode::kOverLimit, path + ": its " + std::to_string(layout.frames) +
                                           " frames take over 16 GiB; cut it into several");
}

Layout read_pc2_header(const std::string& path, ByteSpan bytes, const PointCacheOptions& options) {
  constexpr std::endian kOrder = std::endian::little;
  if (bytes.size() < kPc2HeaderBytes) throw bad_input(path, "is cut short within its header");
  const std::uint32_t version = number_at<std::uint32_t>(bytes, 12, kOrder);
  if (version != 1)
    throw bad_input(path, "is version " + std::to_string(version) + " of PC2; only 1 can be read");
  Layout layout{kOrder,
                number_at<std::uint32_t>(bytes, 16, kOrder),
                number_at<std::uint32_t>(bytes, 28, kOrder),
                kPc2HeaderBytes,
                {}};
  check_extent(path, layout, bytes, options.vertex_count, 0);
  const double rate = number_at<float>(bytes, 24, kOrder);
  if (!(rate > 0 && std::isfinite(rate)))
    throw bad_input(path, "has a sample rate of " + std::to_string(rate) + "; expected above 0");
  for (std::uint32_t i = 0; i < layout.frames; ++i)
    layout.key_times.push_back(i * rate / options.fps);
  return layout;
}

Layout read_mdd_header(const std::string& path, ByteSpan bytes, const PointCacheOptions& options) {
  constexpr std::endian kOrder = std::endian::big;
  if (bytes.size() < kMddHeaderBytes) throw bad_input(path, "is cut short within its header");
  Layout layout{kOrder,
                number_at<std::uint32_t>(bytes, 4, kOrder),
                number_at<std::uint32_t>(bytes, 0, kOrder),
                kMddHeaderBytes,
                {}};
  check_extent(path, layout, bytes, options.vertex_count, 4);
  layout.first_point += std::size_t{4} * layout.frames;
  const double start = number_at<float>(bytes, kMddHeaderBytes, kOrder);
  for (std::size_t i = 0; i < layout.frames; ++i) {
    const double time = number_at<float>(bytes, kMddHeaderBytes + 4 * i, kOrder) - start;
    const bool rises = i == 0 || time > layout.key_times.back();
    if (!std::isfinite(time) || !rises)
      throw bad_input(path, "frame " + std::to_string(i) +
                                " is not later than the one before it; export the cache again");
    layout.key_times.push_back(time);
  }
  return layout;
}

/// One frame; false where a coordinate is not finite.
bool copy_frame(ByteSpan bytes, std::endian order, std::span<Vec3f> out) {
  bool finite = true;
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t a = 0; a < 3; ++a) {
      const float value = number_at<float>(bytes, kPointBytes * i + 4 * a, order);
      finite &= std::isfinite(value);
      out[i][a] = value;
    }
  }
  return finite;
}

/// The first frame with a coordinate that is not finite, or the number of frames.
std::uint32_t copy_frames(ByteSpan bytes, const Layout& layout, PositionList& positions,
                          ProgressSink& progress) {
  const std::size_t frame_bytes = std::size_t{layout.points} * kPointBytes;
  std::atomic<std::uint32_t> broken{layout.frames};
  for (std::size_t begin = 0; begin < layout.frames; begin += kFramesPerReport) {
    progress.report("read", static_cast<double>(begin) / layout.frames);
    const std::size_t count = std::min<std::size_t>(kFramesPerReport, layout.frames - begin);
    positions.resize((begin + count) * layout.points);  // cleared just before it is filled
    parallel_chunks(count, 1, [&](std::size_t from, std::size_t to) {
      for (std::size_t frame = begin + from; frame < begin + to; ++frame) {
        const ByteSpan source =
            bytes.subspan(layout.first_point + frame * frame_bytes, frame_bytes);
        const std::span<Vec3f> target =
            std::span(positions).subspan(frame * layout.points, layout.points);
        if (copy_frame(source, layout.order, target)) continue;
        std::uint32_t known = broken.load();
        while (frame < known &&
               !broken.compare_exchange_weak(known, static_cast<std::uint32_t>(frame))) {
        }
      }
    });
  }
  return broken.load();
}

}  // namespace

PointCache read_point_cache(const std::string& path, const PointCacheOptions& options,
                            ProgressSink& progress) {
  const MappedFile file(path);
  const ByteSpan bytes = file.bytes();
  const bool is_pc2 = bytes.size() >= kPc2Magic.size() &&
                      std::memcmp(bytes.data(), kPc2Magic.data(), kPc2Magic.size()) == 0;
  Layout layout =
      is_pc2 ? read_pc2_header(path, bytes, options) : read_mdd_header(path, bytes, options);
  PointCache cache;
  cache.positions = PositionList(options.scratch);
  cache.positions.reserve(std::size_t{layout.points} * layout.frames);
  const std::uint32_t broken = copy_frames(bytes, layout, cache.positions, progress);
  if (broken < layout.frames)
    throw bad_input(
        path, "frame " + std::to_string(broken) + " has a coordinate that is not a finite number");
  cache.key_times = std::move(layout.key_times);
  progress.report("read", 1.0);
  return cache;
}

}  // namespace mdk
