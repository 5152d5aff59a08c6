// Damaged files, systematically: each is refused, or what it gives can be walked as tracing walks
// it. Run under AddressSanitizer this is the proof that opening checks enough. Flips are tried as
// they are (checksums catch them) and with the checksum made right again (the structural checks
// must).
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <iterator>
#include <optional>
#include <vector>

#include "tests/formats/mdk/hostile_file.h"
#include "tests/formats/mdk/mdk_image.h"

namespace mdk::test {
namespace {

constexpr std::size_t kOffsetOfFileSize = 16;

/// Reads what tracing and shading read, by the same links. Returns a digest, so that nothing of it
/// is optimised away.
class Walk {
 public:
  explicit Walk(const ModelView& model) : model_(model), poses_(model.key_count()) {}

  std::uint64_t everything() {
    for (std::uint32_t clip = 0; clip < model_.clips.size(); ++clip) times(clip);
    for (std::uint32_t s = 0; s < model_.segment_count(); ++s)
      for (std::uint32_t c = 0; c < model_.cluster_count(); ++c) fuzzy(s, c);
    for (std::uint32_t t = 0; t < model_.triangle_count(); ++t) look(t);
    for (std::uint32_t key = 0; key < model_.key_count(); ++key) {
      for (const Affine3f& map : model_.key_maps(key)) see(map);
      for (std::uint32_t c = 0; c < model_.cluster_count(); ++c) see_box(model_.world_box(key, c));
      EXPECT_LT(clip_of_key(model_, key), model_.clips.size());
    }
    return digest_;
  }

 private:
  template <class T>
  void see(const T& value) {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (const unsigned char byte : bytes) digest_ = digest_ * 31 + byte;
  }

  void see_box(const Aabb& box) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_TRUE(std::isfinite(box.lo[axis]) && box.lo[axis] <= box.hi[axis] &&
                  std::isfinite(box.hi[axis]));
    see(box);
  }

  /// Decoded when it is first asked for.
  const std::vector<Vec3f>& pose(std::uint32_t key) {
    if (poses_[key].empty()) {
      poses_[key].resize(model_.vertex_count);
      decode_pose(model_, key, {0, model_.vertex_count}, poses_[key]);
    }
    return poses_[key];
  }

  void times(std::uint32_t clip) {
    const double end = model_.clip_seconds(model_.clips[clip]);
    for (const double seconds : {-1.0, 0.0, end / 3, end / 2, std::nextafter(end, 0.0), end,
                                 end + 1, std::nan(""), HUGE_VAL}) {
      const KeyInterval at = locate_time(model_, clip, seconds);
      EXPECT_TRUE(at.s >= 0 && at.s < 1);
      const std::uint32_t segment = segment_of(model_, at);
      ASSERT_LT(segment, model_.segment_count());
      EXPECT_LE(model_.segments[segment].first_key, at.key0);
      EXPECT_GE(model_.segments[segment].last_key, at.key1);
      see(pose(at.key0).back());
      see(pose(at.key1).back());
    }
  }

  /// Depth first with a stack of the length the traversals have.
  void fuzzy(std::uint32_t segment, std::uint32_t cluster) {
    const KdTreeView tree = model_.tree_view(model_.segment_trees(segment)[cluster]);
    for (const Aabb& box : model_.cluster_fuzzy_boxes(segment, cluster)) see_box(box);
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
        corners(segment, cluster, t);
    }
  }

  void corners(std::uint32_t segment, std::uint32_t cluster, std::uint32_t triangle) {
    for (const std::uint32_t v : model_.triangles[triangle].v) {
      for (std::uint32_t key = 0; key < model_.key_count(); ++key) see(pose(key)[v]);
    }
    see_box(model_.fuzzy_box(segment, cluster, triangle));
  }

  void look(std::uint32_t triangle) {
    EXPECT_LT(model_.source_triangles[triangle], model_.triangle_count());
    for (std::size_t corner = 3 * std::size_t{triangle}; corner < 3 * std::size_t{triangle} + 3;
         ++corner) {
      if (!model_.appearance.corner_texcoords.empty())
        see(model_.appearance.corner_texcoords[corner]);
      if (!model_.appearance.corner_colors.empty()) see(model_.appearance.corner_colors[corner]);
    }
    const Material& material =
        model_.appearance.materials[model_.appearance.triangle_materials[triangle]];
    if (material.texture == kNoTexture) return;
    const Texture& texture = model_.appearance.textures[material.texture];
    for (std::uint64_t y : {0u, texture.height - 1}) {
      for (std::uint64_t x : {0u, texture.width - 1}) {
        see(model_.appearance.texels[texture.first_texel + y * texture.width + x]);
      }
    }
  }

  const ModelView& model_;
  std::vector<std::vector<Vec3f>> poses_;
  std::uint64_t digest_ = 0;
};

/// What became of the files of a test.
struct Tally {
  std::size_t refused = 0, walked = 0;
  std::uint64_t digest = 0;

  void add(const std::optional<ModelStorage>& opened) {
    if (!opened) {
      ++refused;
      return;
    }
    ++walked;
    const ModelView model = opened->view();
    digest += Walk(model).everything();
  }
};

struct Sample {
  const char* name;
  ModelStorage (*make)();
};

class MdkHostile : public testing::TestWithParam<Sample> {};

INSTANTIATE_TEST_SUITE_P(Poses, MdkHostile,
                         testing::Values(Sample{"KeyPositions", sample_model},
                                         Sample{"Rig", sample_rig_model},
                                         Sample{"Quantized", sample_quantized_model}),
                         [](const auto& tested) { return tested.param.name; });

TEST_P(MdkHostile, TheUndamagedFileCanBeWalked) {
  HostileFile file(GetParam().make());
  Tally tally;
  tally.add(file.open(file.bytes()));
  EXPECT_EQ(tally.walked, 1u);
}

TEST_P(MdkHostile, AFileCutAtAnyLengthIsRefused) {
  HostileFile file(GetParam().make());
  Bytes cut = file.bytes();
  while (!cut.empty()) {
    cut.pop_back();
    ASSERT_FALSE(file.open(cut).has_value()) << cut.size();
  }
}

TEST_P(MdkHostile, AFileCutAtAnyLengthWithAMatchingHeaderIsRefusedOrSafe) {
  HostileFile file(GetParam().make());
  Tally tally;
  Bytes cut = file.bytes();
  while (cut.size() > kHeaderBytes) {
    cut.pop_back();
    put(cut, kOffsetOfFileSize, static_cast<std::uint64_t>(cut.size()));
    seal(cut);
    tally.add(file.open(cut));
  }
  const std::size_t padding = file.bytes().size() - file.ranges().back().end;
  EXPECT_EQ(tally.walked, padding) << "nothing but padding may be missing";
}

TEST_P(MdkHostile, AnyBitFlippedInHeaderOrTableIsRefused) {
  HostileFile file(GetParam().make());
  const ByteRange table = file.ranges().front();
  for (std::size_t at = table.begin; at < table.end; ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      ASSERT_FALSE(file.open(file.with_flip(at, bit)).has_value())
          << "byte " << at << " bit " << bit;
    }
  }
}

TEST_P(MdkHostile, AnyBitFlippedAnywhereAndResealedIsRefusedOrSafe) {
  HostileFile file(GetParam().make());
  for (const ByteRange& range : file.ranges()) {
    Tally tally;
    for (std::size_t at = range.begin; at < range.end; ++at) {
      for (int bit = 0; bit < 8; ++bit) {
        Bytes damaged = file.with_flip(at, bit);
        seal(damaged);
        tally.add(file.open(damaged));
        ASSERT_FALSE(testing::Test::HasFailure())
            << range.name << " byte " << at - range.begin << " bit " << bit;
      }
    }
    const bool may_hold_anything = range.name == "POSE" || range.name == "UVCO" ||
                                   range.name == "COLR" || range.name == "TEXL" ||
                                   range.name == "QBIT";
    if (!may_hold_anything && range.end > range.begin) {
      EXPECT_GT(tally.refused, 0u) << range.name << " is not checked at all";
    }
  }
}

TEST_P(MdkHostile, AnyWordReplacedByAnExtremeAndResealedIsRefusedOrSafe) {
  HostileFile file(GetParam().make());
  Tally tally;
  for (const ByteRange& range : file.ranges()) {
    for (std::size_t at = range.begin; at + 4 <= range.end; at += 4) {
      for (const std::uint32_t word : extreme_words()) {
        tally.add(file.open(file.with_word(at, word)));
        ASSERT_FALSE(testing::Test::HasFailure())
            << range.name << " byte " << at - range.begin << " word " << word;
      }
    }
  }
  EXPECT_GT(tally.refused, 0u);
  EXPECT_GT(tally.walked, 0u);
}

TEST_P(MdkHostile, SectionsThatShareBytesAreRefusedOrSafe) {
  HostileFile file(GetParam().make());
  Tally tally;
  const auto table = read_table(file.bytes());
  for (const ImageSection& moved : table) {
    for (const ImageSection& onto : table) {
      Bytes damaged = file.bytes();
      put(damaged, entry_offset(damaged, moved.id) + 24, onto.offset);
      seal(damaged);
      tally.add(file.open(damaged));
      ASSERT_FALSE(testing::Test::HasFailure()) << moved.id << " onto " << onto.id;
    }
  }
  EXPECT_GE(tally.walked, table.size()) << "each one onto itself";
}

}  // namespace
}  // namespace mdk::test
