// Damaged files, systematically: each is refused, or what it gives can be walked as tracing walks
// it. Run under AddressSanitizer this is the proof that opening checks enough. Flips are tried as
// they are (checksums catch them) and with the checksum made right again (the structural checks
// must).
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "common/base/error.h"
#include "formats/mdk_view.h"
#include "formats/mdk_writer.h"
#include "tests/formats/mdk_image.h"
#include "tests/formats/sample_model.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

constexpr std::size_t kOffsetOfFileSize = 16;

/// Each list in a block of its own, where AddressSanitizer sees one step outside; in the mapping it
/// would see the neighbour.
ModelStorage copy_of(const Model& model) {
  ModelStorage copy;
  copy.vertex_count = model.vertex_count;
  copy.rest_key = model.rest_key;
  copy.bounds = model.bounds;
  copy.rest_diagonal = model.rest_diagonal;
  const auto copy_list = [](auto& to, auto from) { to.assign(from.begin(), from.end()); };
  copy_list(copy.clips, model.clips);
  copy_list(copy.key_times, model.key_times);
  copy_list(copy.key_positions, model.key_positions);
  copy_list(copy.triangles, model.triangles);
  copy_list(copy.source_triangles, model.source_triangles);
  copy_list(copy.clusters, model.clusters);
  copy_list(copy.local_from_world, model.local_from_world);
  copy_list(copy.cluster_world_boxes, model.cluster_world_boxes);
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

/// Reads what tracing and shading read, by the same links. Returns a digest, so that nothing of it
/// is optimised away.
class Walk {
 public:
  explicit Walk(const Model& model) : model_(model) {}

  std::uint64_t everything() {
    for (std::uint32_t clip = 0; clip < model_.clips.size(); ++clip) times(clip);
    for (const Cluster& cluster : model_.clusters) tree(model_.fuzzy_tree(cluster));
    for (std::uint32_t t = 0; t < model_.triangle_count(); ++t) look(t);
    for (std::uint32_t key = 0; key < model_.key_count(); ++key) {
      for (const Affine3f& map : model_.key_maps(key)) see(map);
      for (const Aabb& box : model_.key_world_boxes(key)) see(box);
      EXPECT_LT(clip_of_key(model_, key), model_.clips.size());
    }
    for (const Aabb& box : model_.fuzzy_boxes) see(box);
    return digest_;
  }

 private:
  template <class T>
  void see(const T& value) {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (const unsigned char byte : bytes) digest_ = digest_ * 31 + byte;
  }

  void times(std::uint32_t clip) {
    const double end = model_.clip_seconds(model_.clips[clip]);
    for (const double seconds : {-1.0, 0.0, end / 3, end / 2, std::nextafter(end, 0.0), end,
                                 end + 1, std::nan(""), HUGE_VAL}) {
      const KeyInterval at = locate_time(model_, clip, seconds);
      EXPECT_TRUE(at.s >= 0 && at.s < 1);
      see(model_.key_pose(at.key0).back());
      see(model_.key_pose(at.key1).back());
    }
  }

  /// Depth first with a stack of the length the traversals have.
  void tree(const KdTreeView& tree) {
    std::uint32_t stack[kMaxKdDepth + 1];
    std::size_t height = 0, steps = 0, refs = 0;
    stack[height++] = 0;
    while (height > 0) {
      ASSERT_LE(++steps, tree.nodes.size()) << "a node is reached twice";
      const KdNode& node = tree.nodes[stack[--height]];
      if (!node.is_leaf()) {
        ASSERT_LE(height + 2, std::size(stack)) << "deeper than stacks are";
        stack[height++] = node.above();
        stack[height++] = node.below();
        continue;
      }
      ASSERT_LE(refs += node.ref_count(), tree.refs.size()) << "a reference is listed twice";
      for (const std::uint32_t t : tree.refs.subspan(node.first_ref(), node.ref_count()))
        corners(t);
    }
  }

  void corners(std::uint32_t triangle) {
    for (const std::uint32_t v : model_.triangles[triangle].v) {
      for (std::uint32_t key = 0; key < model_.key_count(); ++key) see(model_.key_pose(key)[v]);
    }
    see(model_.fuzzy_boxes[triangle]);
  }

  void look(std::uint32_t triangle) {
    EXPECT_LT(model_.source_triangles[triangle], model_.triangle_count());
    for (std::size_t corner = 3 * std::size_t{triangle}; corner < 3 * std::size_t{triangle} + 3;
         ++corner) {
      if (!model_.corner_texcoords.empty()) see(model_.corner_texcoords[corner]);
      if (!model_.corner_colors.empty()) see(model_.corner_colors[corner]);
    }
    const Material& material = model_.materials[model_.triangle_materials[triangle]];
    if (material.texture == kNoTexture) return;
    const Texture& texture = model_.textures[material.texture];
    for (std::uint64_t y : {0u, texture.height - 1}) {
      for (std::uint64_t x : {0u, texture.width - 1}) {
        see(model_.texels[texture.first_texel + y * texture.width + x]);
      }
    }
  }

  const Model& model_;
  std::uint64_t digest_ = 0;
};

enum class Outcome { kRefused, kWalked };

class MdkHostileTest : public testing::Test {
 protected:
  MdkHostileTest() {
    write_mdk(sample_model().view(), path_);
    bytes_ = read_bytes(path_);
    descriptor_ = ::open(path_.c_str(), O_RDWR);
  }
  ~MdkHostileTest() override { ::close(descriptor_); }

  /// Any exception but a refusal fails the test.
  Outcome open_and_walk(const Bytes& bytes) {
    EXPECT_EQ(::ftruncate(descriptor_, static_cast<off_t>(bytes.size())), 0);
    EXPECT_EQ(::pwrite(descriptor_, bytes.data(), bytes.size(), 0),
              static_cast<ssize_t>(bytes.size()));
    try {
      const MdkFile file(path_);
      const ModelStorage copy = copy_of(file.model());
      const Model model = copy.view();
      digest_ += Walk(model).everything();
      return Outcome::kWalked;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput) << error.what();
      EXPECT_THAT(error.what(), testing::StartsWith(path_ + ": "));
      return Outcome::kRefused;
    }
  }

  /// Header and table, then every section: [begin, end) in the file.
  struct Range {
    std::string name;
    std::size_t begin = 0, end = 0;
  };
  std::vector<Range> ranges() const {
    const auto table = read_table(bytes_);
    std::vector<Range> ranges = {
        {"header and table", 0, kHeaderBytes + table.size() * kEntryBytes}};
    for (const ImageSection& section : table) {
      ranges.push_back({section.id, section.offset, section.offset + section.bytes()});
    }
    return ranges;
  }

  TempFolder folder_;
  std::string path_ = folder_.file("sample.mdk");
  Bytes bytes_;
  int descriptor_ = -1;
  std::uint64_t digest_ = 0;
};

TEST_F(MdkHostileTest, TheUndamagedFileCanBeWalked) {
  EXPECT_EQ(open_and_walk(bytes_), Outcome::kWalked);
}

TEST_F(MdkHostileTest, AFileCutAtAnyLengthIsRefused) {
  for (std::size_t length = 0; length < bytes_.size(); ++length) {
    const Bytes cut(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(length));
    ASSERT_EQ(open_and_walk(cut), Outcome::kRefused) << length;
  }
}

TEST_F(MdkHostileTest, AFileCutAtAnyLengthWithAMatchingHeaderIsRefusedOrSafe) {
  std::size_t refused = 0;
  for (std::size_t length = kHeaderBytes; length < bytes_.size(); ++length) {
    Bytes cut(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(length));
    put(cut, kOffsetOfFileSize, static_cast<std::uint64_t>(length));
    seal(cut);
    refused += open_and_walk(cut) == Outcome::kRefused;
  }
  const ImageSection last = read_table(bytes_).back();
  EXPECT_EQ(refused, last.offset + last.bytes() - kHeaderBytes) << "only padding may be missing";
}

TEST_F(MdkHostileTest, AnyBitFlippedInHeaderOrTableIsRefused) {
  const Range table = ranges().front();
  for (std::size_t at = table.begin; at < table.end; ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes damaged = bytes_;
      damaged[at] ^= static_cast<unsigned char>(1u << bit);
      ASSERT_EQ(open_and_walk(damaged), Outcome::kRefused) << "byte " << at << " bit " << bit;
    }
  }
}

TEST_F(MdkHostileTest, AnyBitFlippedAnywhereAndResealedIsRefusedOrSafe) {
  for (const Range& range : ranges()) {
    std::size_t refused = 0, walked = 0;
    for (std::size_t at = range.begin; at < range.end; ++at) {
      for (int bit = 0; bit < 8; ++bit) {
        Bytes damaged = bytes_;
        damaged[at] ^= static_cast<unsigned char>(1u << bit);
        seal(damaged);
        (open_and_walk(damaged) == Outcome::kRefused ? refused : walked) += 1;
        ASSERT_FALSE(HasFailure()) << range.name << " byte " << at - range.begin << " bit " << bit;
      }
    }
    std::printf("%-16s %5zu refused %5zu walked\n", range.name.c_str(), refused, walked);
    const bool may_hold_anything = range.name == "POSE" || range.name == "UVCO" ||
                                   range.name == "COLR" || range.name == "TEXL";
    if (!may_hold_anything) {
      EXPECT_GT(refused, 0u) << range.name << " is not checked at all";
    }
  }
}

TEST_F(MdkHostileTest, AnyWordReplacedByAnExtremeAndResealedIsRefusedOrSafe) {
  const std::uint32_t extremes[] = {0,
                                    1,
                                    2,
                                    0x3fffffff,
                                    0x40000000,
                                    0x7fffffff,
                                    0x80000000,
                                    0xfffffffe,
                                    0xffffffff,
                                    std::bit_cast<std::uint32_t>(std::nanf("")),
                                    std::bit_cast<std::uint32_t>(HUGE_VALF)};
  for (const Range& range : ranges()) {
    for (std::size_t at = range.begin; at + 4 <= range.end; at += 4) {
      for (const std::uint32_t extreme : extremes) {
        Bytes damaged = bytes_;
        put(damaged, at, extreme);
        seal(damaged);
        open_and_walk(damaged);
        ASSERT_FALSE(HasFailure()) << range.name << " byte " << at - range.begin << " " << extreme;
      }
    }
  }
}

TEST_F(MdkHostileTest, SectionsThatShareBytesAreRefusedOrSafe) {
  const auto table = read_table(bytes_);
  for (const ImageSection& moved : table) {
    for (const ImageSection& onto : table) {
      Bytes damaged = bytes_;
      put(damaged, entry_offset(bytes_, moved.id) + 24, onto.offset);
      seal(damaged);
      open_and_walk(damaged);
      ASSERT_FALSE(HasFailure()) << moved.id << " onto " << onto.id;
    }
  }
}

}  // namespace
}  // namespace mdk::test
