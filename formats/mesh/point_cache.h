// Reads point caches (.pc2, .mdd): where every vertex of a mesh is, frame by frame.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "common/motion/pose_sequence.h"

namespace mdk {

struct PointCache {
  std::vector<double> key_times;  ///< seconds from the first frame, rising
  PositionList positions;         ///< key-major, as many per key as the mesh has vertices
};

struct PointCacheOptions {
  double fps = 30;                 ///< frames per second, where the file counts frames (.pc2)
  std::uint32_t vertex_count = 0;  ///< of the mesh that is moved
  ScratchSpace scratch = {};       ///< where the positions stand
};

/// POINTCACHE2 version 1 (little-endian; frames `rate` apart, at `fps`) or, for any other start,
/// MDD (big-endian; a time in seconds per frame). Throws Error: kIo (cannot read), kBadInput (cut
/// short, made for another mesh, coordinates that are not finite), kOverLimit (over 16 GiB).
PointCache read_point_cache(const std::string& path, const PointCacheOptions& options,
                            ProgressSink& progress);

}  // namespace mdk
