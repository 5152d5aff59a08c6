// Time segments: extreme frames spoil the fuzzy boxes of all others, so the time line is cut into
// stretches with boxes and trees of their own (GFW06 §6, future work). One segment is the paper;
// one per interval between keys is a refit done ahead of time; this is the dial between them.
//
// A moment costs the work of a ray that meets the model then (cost.h); a segment costs memory on
// top, at a price in work. Cuts are chosen by dynamic programming over candidates: some blocks of
// intervals whose boxes are made once; a run of blocks has the unions of their boxes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "common/math/affine3.h"
#include "common/motion/model.h"
#include "common/motion/pose_sequence.h"
#include "preprocess/cluster_members.h"

namespace mdk {

struct SegmentOptions {
  std::uint32_t count = 0;  ///< exactly so many, or as many as there can be; 0: as many as pay
  /// What a byte of boxes and trees per triangle of the model must save at least, in expected
  /// triangle tests per ray that meets it.
  double price_per_byte = 0.01;
};

/// The smallest segments there can be: the intervals between neighbouring keys of each clip, and
/// the clips of one key. In key order; any run of them is a segment.
std::vector<Segment> smallest_segments(std::span<const Clip> clips);

/// Cuts the time line. `local_from_world`: F * K as stored, key-major. Cost: as fuzzy_boxes() on a
/// few thousand triangles, and a few thousand unions of those.
std::vector<Segment> choose_segments(const PoseSequence& sequence, const ClusterMembers& members,
                                     std::span<const Affine3f> local_from_world,
                                     const SegmentOptions& options);

/// Area of the box of each pose.
std::vector<double> pose_box_areas(const PoseSequence& sequence);

}  // namespace mdk
