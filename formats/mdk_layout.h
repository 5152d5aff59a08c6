// The .mdk file's bytes as types: header, section table, records, and which section holds which
// part of a Model (docs/file-format.md). The records of common/ that the file holds as they are get
// pinned here.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "common/motion/model.h"

namespace mdk::layout {

static_assert(std::endian::native == std::endian::little,
              "the file is read in place: a big-endian machine needs a converting reader");

inline constexpr std::array<unsigned char, 8> kMagic = {0x89, 'M',  'D',  'K',
                                                        '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kByteOrder = 0x01020304;
inline constexpr std::uint16_t kMajorVersion = 3;
inline constexpr std::uint16_t kMinorVersion = 0;
inline constexpr std::uint64_t kAlignment = 64;
inline constexpr std::uint32_t kMaxSections = 256;
inline constexpr std::uint32_t kSectionNeeded =
    1;  ///< flag: whoever does not know the id must refuse

struct FileHeader {
  std::array<unsigned char, 8> magic = kMagic;
  std::uint32_t byte_order = kByteOrder;
  std::uint16_t major_version = kMajorVersion, minor_version = kMinorVersion;
  std::uint64_t file_bytes = 0;
  std::uint32_t section_count = 0;
  std::uint16_t tool_version[3] = {};  ///< major, minor, patch
  std::uint16_t source_reader = 0;      ///< a SourceReader
  std::uint32_t reserved_too = 0;
  std::uint64_t options_hash = 0;
  std::uint64_t reserved_last = 0;
  std::uint64_t checksum = 0;  ///< of all before it and the section table
};
static_assert(sizeof(FileHeader) == 64 && offsetof(FileHeader, checksum) == 56);
static_assert(offsetof(FileHeader, tool_version) == 28 && offsetof(FileHeader, options_hash) == 40);

struct SectionEntry {
  std::uint32_t id = 0;
  std::uint32_t flags = 0;
  std::uint32_t element_bytes = 0;
  std::uint32_t reserved = 0;
  std::uint64_t element_count = 0;
  std::uint64_t offset = 0;
  std::uint64_t checksum = 0;

  /// Meaningful once the entry was checked against its file.
  std::uint64_t bytes() const { return element_count * element_bytes; }
};
static_assert(sizeof(SectionEntry) == 40);

struct ModelRecord {
  std::uint32_t vertex_count = 0, key_count = 0, triangle_count = 0, cluster_count = 0;
  std::uint32_t clip_count = 0, rest_key = 0;
  PoseKind pose_kind = PoseKind::kKeyPositions;
  std::uint32_t segment_count = 0;
  double rest_diagonal = 0;
  Aabb bounds;
};
static_assert(sizeof(ModelRecord) == 64 && offsetof(ModelRecord, bounds) == 40);

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

struct SectionKind {
  std::uint32_t id = 0;
  std::string_view name;  ///< as in docs/file-format.md
};

/// Four letters as a number, the first in the lowest byte.
constexpr std::uint32_t fourcc(const char (&letters)[5]) {
  std::uint32_t id = 0;
  for (int i = 0; i < 4; ++i) {
    id |= static_cast<std::uint32_t>(static_cast<unsigned char>(letters[i])) << (8 * i);
  }
  return id;
}

inline constexpr SectionKind kModel{fourcc("MODL"), "model"};
inline constexpr SectionKind kClips{fourcc("CLIP"), "clips"};
inline constexpr SectionKind kClipNames{fourcc("NAME"), "clip_names"};
inline constexpr SectionKind kKeyTimes{fourcc("TIME"), "key_times"};
inline constexpr SectionKind kClusters{fourcc("CLUS"), "clusters"};
inline constexpr SectionKind kSegments{fourcc("SEGM"), "segments"};
inline constexpr SectionKind kFuzzyTrees{fourcc("FTRE"), "fuzzy_trees"};
inline constexpr SectionKind kKdNodes{fourcc("NODE"), "kd_nodes"};
inline constexpr SectionKind kKdRefs{fourcc("REFS"), "kd_refs"};
inline constexpr SectionKind kTriangles{fourcc("TRIS"), "triangles"};
inline constexpr SectionKind kSourceTriangles{fourcc("SRCT"), "source_triangles"};
inline constexpr SectionKind kLocalFromWorld{fourcc("MAPS"), "local_from_world"};
inline constexpr SectionKind kKeyBoxes{fourcc("KBOX"), "key_boxes"};
inline constexpr SectionKind kWorldBoxes{fourcc("WBOX"), "cluster_world_boxes"};
inline constexpr SectionKind kFuzzyBoxes{fourcc("FBOX"), "fuzzy_boxes"};
inline constexpr SectionKind kMaterials{fourcc("MATL"), "materials"};
inline constexpr SectionKind kTriangleMaterials{fourcc("TMAT"), "triangle_materials"};
inline constexpr SectionKind kTexcoords{fourcc("UVCO"), "corner_texcoords"};
inline constexpr SectionKind kColors{fourcc("COLR"), "corner_colors"};
inline constexpr SectionKind kTextures{fourcc("TEXI"), "textures"};
inline constexpr SectionKind kTexels{fourcc("TEXL"), "texels"};
inline constexpr SectionKind kBoneMaps{fourcc("BONE"), "bone_maps"};
inline constexpr SectionKind kTargetWeights{fourcc("TGTW"), "target_weights"};
inline constexpr SectionKind kBasePositions{fourcc("BASE"), "base_positions"};
inline constexpr SectionKind kFirstWeight{fourcc("BWFI"), "first_weight"};
inline constexpr SectionKind kBoneWeights{fourcc("BWGT"), "bone_weights"};
inline constexpr SectionKind kFirstOffset{fourcc("MOFI"), "first_offset"};
inline constexpr SectionKind kMorphOffsets{fourcc("MOFF"), "morph_offsets"};
inline constexpr SectionKind kJoints{fourcc("JNTS"), "joints"};
inline constexpr SectionKind kJointNames{fourcc("JNAM"), "joint_names"};
inline constexpr SectionKind kBoneBindings{fourcc("BIND"), "bone_bindings"};
inline constexpr SectionKind kClusterBones{fourcc("CBON"), "cluster_bones"};
inline constexpr SectionKind kQuantizationError{fourcc("QERR"), "quantization_error"};
inline constexpr SectionKind kRunVertices{fourcc("QRUN"), "first_vertex"};
inline constexpr SectionKind kRestPositions{fourcc("QRES"), "rest_positions"};
inline constexpr SectionKind kQuantizedBlocks{fourcc("QBLK"), "quantized_blocks"};
inline constexpr SectionKind kQuantizedWords{fourcc("QBIT"), "quantized_words"};
inline constexpr SectionKind kKeyPositions{fourcc("POSE"), "key_positions"};

/// Calls visit(kind, span) for the lists of a model that stand in a section of their own and are
/// mapped as they are, in file order: what opening reads first, the bulk last. Clips and scalars
/// are records of their own and not visited.
template <class ModelRef, class Visit>
void for_each_array(ModelRef&& model, Visit&& visit) {
  visit(kKeyTimes, model.key_times);
  visit(kClusters, model.clusters);
  visit(kSegments, model.segments);
  visit(kFuzzyTrees, model.fuzzy_trees);
  visit(kKdNodes, model.kd_nodes);
  visit(kKdRefs, model.kd_refs);
  visit(kTriangles, model.triangles);
  visit(kSourceTriangles, model.source_triangles);
  visit(kLocalFromWorld, model.local_from_world);
  visit(kKeyBoxes, model.key_boxes);
  visit(kWorldBoxes, model.cluster_world_boxes);
  visit(kFuzzyBoxes, model.fuzzy_boxes);
  visit(kMaterials, model.materials);
  visit(kTriangleMaterials, model.triangle_materials);
  visit(kTexcoords, model.corner_texcoords);
  visit(kColors, model.corner_colors);
  visit(kTextures, model.textures);
  visit(kTexels, model.texels);
  visit(kBoneMaps, model.poses.rig.bone_maps);
  visit(kTargetWeights, model.poses.rig.target_weights);
  visit(kBasePositions, model.poses.rig.base_positions);
  visit(kFirstWeight, model.poses.rig.first_weight);
  visit(kBoneWeights, model.poses.rig.bone_weights);
  visit(kFirstOffset, model.poses.rig.first_offset);
  visit(kMorphOffsets, model.poses.rig.morph_offsets);
  visit(kJoints, model.skeleton.joints);
  visit(kJointNames, model.skeleton.names);
  visit(kBoneBindings, model.skeleton.bones);
  visit(kClusterBones, model.cluster_bones);
  visit(kQuantizationError, model.poses.quantized.error);
  visit(kRunVertices, model.poses.quantized.first_vertex);
  visit(kRestPositions, model.poses.quantized.rest_positions);
  visit(kQuantizedBlocks, model.poses.quantized.blocks);
  visit(kQuantizedWords, model.poses.quantized.words);
  visit(kKeyPositions, model.poses.key_positions);
}

constexpr std::uint64_t align_up(std::uint64_t offset) {
  return (offset + kAlignment - 1) / kAlignment * kAlignment;
}

}  // namespace mdk::layout
