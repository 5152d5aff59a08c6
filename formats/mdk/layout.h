// The .mdk file's bytes as types: its records (docs/file-format.md). Which section holds which
// array of a model is said with the arrays (common/motion/model.h); their records, which the file
// holds as they are, get pinned here.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/motion/model.h"
#include "formats/files/sections.h"

namespace mdk::layout {

inline constexpr std::array<unsigned char, 8> kMagic = {0x89, 'M',  'D',  'K',
                                                        '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint16_t kMajorVersion = 3;
inline constexpr std::uint16_t kMinorVersion = 0, kMinorVersionOfFlags = 1;

struct ModelRecord {
  std::uint32_t vertex_count = 0, key_count = 0, triangle_count = 0, cluster_count = 0;
  std::uint32_t clip_count = 0, rest_key = 0;
  std::uint16_t pose_kind = 0, flags = 0;  ///< a PoseKind; kKeysOnly or nothing
  std::uint32_t segment_count = 0;
  double rest_diagonal = 0;
  Aabb bounds;
};
static_assert(sizeof(ModelRecord) == 64 && offsetof(ModelRecord, bounds) == 40);
static_assert(offsetof(ModelRecord, pose_kind) == 24 && offsetof(ModelRecord, flags) == 26);

/// Flag of a model: fuzzy boxes hold at keys only. Programs that do not know flags take it for a
/// part of the pose kind, and refuse the file.
inline constexpr std::uint16_t kKeysOnly = 1;

struct ClipRecord {
  std::uint32_t name_offset = 0, name_bytes = 0;
  std::uint32_t first_key = 0, key_count = 0;
};
static_assert(sizeof(ClipRecord) == 16);

static_assert(sizeof(Aabb) == 24 && sizeof(QuantizedBox) == 12 && sizeof(Affine3f) == 48 &&
              sizeof(Vec3f) == 12);
static_assert(sizeof(Triangle) == 12 && sizeof(TexCoord) == 8 && sizeof(KdNode) == 8);
static_assert(sizeof(Material) == 32 && offsetof(Material, texture) == 16);
static_assert(sizeof(Texture) == 16 && offsetof(Texture, first_texel) == 8);
static_assert(sizeof(Joint) == 80 && offsetof(Joint, parent_from_joint) == 16);
static_assert(sizeof(BoneBinding) == 52 && sizeof(ClusterBone) == 52);
static_assert(sizeof(Cluster) == 8 && sizeof(Segment) == 8);
static_assert(sizeof(FuzzyTree) == 40 && offsetof(FuzzyTree, local_box) == 16);
static_assert(sizeof(PoseKind) == 4 && sizeof(BoneWeight) == 8);
static_assert(sizeof(QuantizationError) == 16 && sizeof(QuantizedBlock) == 72);
static_assert(offsetof(QuantizedBlock, bits) == 60 && offsetof(QuantizedBlock, first_bit) == 64);
static_assert(sizeof(MorphOffset) == 16 && offsetof(MorphOffset, offset) == 4);

/// What stands in sections in another form than in the model; all else is
/// ModelView::for_each_array.
inline constexpr ModelArray kModel = array_row("MODL", "model", count_rules::exactly(Count::kOne));
inline constexpr ModelArray kClips = array_row("CLIP", "clips", count_rules::some());
inline constexpr ModelArray kClipNames = array_row("NAME", "clip_names", count_rules::any());

extern const FileFormat kMdkFormat;

}  // namespace mdk::layout
