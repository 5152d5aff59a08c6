#include "tests/formats/hostile_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>

#include "common/base/error.h"
#include "formats/mdk_view.h"
#include "formats/mdk_writer.h"
#include "tests/formats/mdk_image.h"

namespace mdk::test {
namespace {

ModelStorage copy_of(const Model& model) {
  ModelStorage copy;
  copy.vertex_count = model.vertex_count;
  copy.rest_key = model.rest_key;
  copy.bounds = model.bounds;
  copy.rest_diagonal = model.rest_diagonal;
  const auto copy_list = [](auto& to, auto from) { to.assign(from.begin(), from.end()); };
  copy_list(copy.clips, model.clips);
  copy_list(copy.key_times, model.key_times);
  copy.poses.kind = model.poses.kind;
  copy_list(copy.poses.key_positions, model.poses.key_positions);
  copy_list(copy.poses.rig.base_positions, model.poses.rig.base_positions);
  copy_list(copy.poses.rig.first_weight, model.poses.rig.first_weight);
  copy_list(copy.poses.rig.bone_weights, model.poses.rig.bone_weights);
  copy_list(copy.poses.rig.first_offset, model.poses.rig.first_offset);
  copy_list(copy.poses.rig.morph_offsets, model.poses.rig.morph_offsets);
  copy_list(copy.poses.rig.bone_maps, model.poses.rig.bone_maps);
  copy_list(copy.poses.rig.target_weights, model.poses.rig.target_weights);
  copy_list(copy.poses.quantized.error, model.poses.quantized.error);
  copy_list(copy.poses.quantized.first_vertex, model.poses.quantized.first_vertex);
  copy_list(copy.poses.quantized.rest_positions, model.poses.quantized.rest_positions);
  copy_list(copy.poses.quantized.blocks, model.poses.quantized.blocks);
  copy_list(copy.poses.quantized.words, model.poses.quantized.words);
  copy_list(copy.triangles, model.triangles);
  copy_list(copy.source_triangles, model.source_triangles);
  copy_list(copy.clusters, model.clusters);
  copy_list(copy.local_from_world, model.local_from_world);
  copy_list(copy.cluster_world_boxes, model.cluster_world_boxes);
  copy_list(copy.skeleton.joints, model.skeleton.joints);
  copy_list(copy.skeleton.names, model.skeleton.names);
  copy_list(copy.skeleton.bones, model.skeleton.bones);
  copy_list(copy.cluster_bones, model.cluster_bones);
  copy_list(copy.segments, model.segments);
  copy_list(copy.fuzzy_trees, model.fuzzy_trees);
  copy_list(copy.fuzzy_boxes, model.fuzzy_boxes);
  copy_list(copy.kd_nodes, model.kd_nodes);
  copy_list(copy.kd_refs, model.kd_refs);
  copy_list(copy.appearance.materials, model.materials);
  copy_list(copy.appearance.triangle_materials, model.triangle_materials);
  copy_list(copy.appearance.corner_texcoords, model.corner_texcoords);
  copy_list(copy.appearance.corner_colors, model.corner_colors);
  copy_list(copy.appearance.textures, model.textures);
  copy_list(copy.appearance.texels, model.texels);
  return copy;
}

}  // namespace

HostileFile::HostileFile(const ModelStorage& sample) : path_(folder_.file("sample.mdk")) {
  write_mdk(sample.view(), path_);
  bytes_ = read_bytes(path_);
  descriptor_ = ::open(path_.c_str(), O_RDWR | O_CLOEXEC);
}

HostileFile::~HostileFile() { ::close(descriptor_); }

std::vector<ByteRange> HostileFile::ranges() const {
  const auto table = read_table(bytes_);
  std::vector<ByteRange> ranges = {
      {"header and table", 0, kHeaderBytes + table.size() * kEntryBytes}};
  for (const ImageSection& section : table) {
    ranges.push_back({section.id, section.offset, section.offset + section.bytes()});
  }
  return ranges;
}

Bytes HostileFile::with_word(std::size_t at, std::uint32_t word) const {
  Bytes damaged = bytes_;
  put(damaged, at, word);
  seal(damaged);
  return damaged;
}

Bytes HostileFile::with_flip(std::size_t at, int bit) const {
  Bytes damaged = bytes_;
  damaged[at] ^= static_cast<unsigned char>(1u << bit);
  return damaged;
}

std::optional<ModelStorage> HostileFile::open(const Bytes& bytes) {
  EXPECT_EQ(::ftruncate(descriptor_, static_cast<off_t>(bytes.size())), 0);
  EXPECT_EQ(::pwrite(descriptor_, bytes.data(), bytes.size(), 0),
            static_cast<ssize_t>(bytes.size()));
  try {
    const MdkFile file(path_);
    return copy_of(file.model());
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kBadInput) << error.what();
    EXPECT_THAT(error.what(), testing::StartsWith(path_ + ": "));
    return std::nullopt;
  }
}

std::vector<std::uint32_t> extreme_words() {
  return {0,
          1,
          2,
          0x3fffffff,
          0x40000000,
          0x7fffffff,
          0x80000000,
          0xfffffffe,
          0xffffffff,
          std::bit_cast<std::uint32_t>(3e38f),
          std::bit_cast<std::uint32_t>(-1e-40f),
          std::bit_cast<std::uint32_t>(std::nanf("")),
          std::bit_cast<std::uint32_t>(HUGE_VALF)};
}

}  // namespace mdk::test
