// The .mdk file's bytes as types: header, section table and records (docs/file-format.md), and the
// sections of a file that is mapped. Which section holds which array of a model is said with the
// arrays (common/motion/model.h); their records, which the file holds as they are, get pinned here.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "common/motion/model.h"

namespace mdk::layout {

static_assert(std::endian::native == std::endian::little,
              "the file is read in place: a big-endian machine needs a converting reader");

inline constexpr std::array<unsigned char, 8> kMagic = {0x89, 'M',  'D',  'K',
                                                        '\r', '\n', 0x1a, '\n'};
inline constexpr std::uint32_t kByteOrder = 0x01020304;
inline constexpr std::uint16_t kMajorVersion = 3;
inline constexpr std::uint16_t kMinorVersion = 0, kMinorVersionOfFlags = 1;
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
  std::uint16_t source_reader = 0;     ///< a SourceReader
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

constexpr std::uint64_t align_up(std::uint64_t offset) {
  return (offset + kAlignment - 1) / kAlignment * kAlignment;
}

/// What stands in `FileHeader::checksum`: of the header before that field, then the table.
std::uint64_t table_checksum(const FileHeader& header, std::span<const SectionEntry> table);

/// The name in docs/file-format.md, or the id's letters in quotes where it is not in there.
std::string section_name(std::uint32_t id);

}  // namespace mdk::layout

namespace mdk {

/// A view of a file's sections; `file` must outlive it.
class MdkSections {
 public:
  /// Checks header and table: after this every section lies inside the file, and every section the
  /// file needs is known. `path` is for the sentences. Throws Error (kBadInput).
  MdkSections(std::span<const std::byte> file, const std::string& path);

  const layout::FileHeader& header() const { return header_; }
  const std::vector<layout::SectionEntry>& table() const { return table_; }
  std::span<const std::byte> content(const layout::SectionEntry& entry) const {
    return file_.subspan(entry.offset, entry.bytes());
  }

  /// The content of the one section of this kind, in place. Throws Error (kBadInput) where there is
  /// none, more than one, or its elements have another size than T.
  template <class T>
  std::span<const T> array(const ModelArray& row) const {
    static_assert(alignof(T) <= layout::kAlignment && std::is_trivially_copyable_v<T>);
    const layout::SectionEntry& entry = only_entry(row, sizeof(T));
    return {reinterpret_cast<const T*>(file_.data() + entry.offset), entry.element_count};
  }

 private:
  const layout::SectionEntry& only_entry(const ModelArray& row, std::uint32_t element_bytes) const;
  layout::FileHeader read_header() const;
  void read_table();
  void check_entry(const layout::SectionEntry& entry) const;

  std::span<const std::byte> file_;
  std::string path_;
  layout::FileHeader header_;
  std::vector<layout::SectionEntry> table_;
};

}  // namespace mdk
