// A short run of what './run fuzz' does for hours: seeds, and mutations of them that are the same
// every time.
#include "tests/fuzz/fuzz_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace mdk::test {
namespace {

constexpr std::uint32_t kSeed = 20060901;
constexpr std::size_t kMutationsPerSeed = 1500;

using Random = std::mt19937;

std::size_t below(Random& random, std::size_t bound) { return random() % bound; }

/// Numbers that upset sizes, links and signs, as bytes in place of what stands there.
void plant_number(Bytes& bytes, Random& random) {
  static constexpr std::uint32_t kNumbers[] = {0,          1,          0x7f,       0xff,
                                               0x7fff,     0xffff,     0x3fffffff, 0x7fffffff,
                                               0x80000000, 0xfffffffe, 0xffffffff, 0x7fc00000};
  const std::uint32_t number = kNumbers[below(random, std::size(kNumbers))];
  const std::size_t width = std::min<std::size_t>(std::size_t{1} << below(random, 3), bytes.size());
  const std::size_t at = below(random, bytes.size() - width + 1);
  for (std::size_t i = 0; i < width; ++i)
    bytes[at + i] = static_cast<unsigned char>(number >> (8 * i));
}

void copy_part(Bytes& bytes, Random& random) {
  const std::size_t from = below(random, bytes.size());
  const std::size_t size = 1 + below(random, std::min<std::size_t>(bytes.size() - from, 64));
  const Bytes part(bytes.begin() + static_cast<std::ptrdiff_t>(from),
                   bytes.begin() + static_cast<std::ptrdiff_t>(from + size));
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(random, bytes.size() + 1)),
               part.begin(), part.end());
}

void erase_part(Bytes& bytes, Random& random) {
  const std::size_t from = below(random, bytes.size());
  const std::size_t size = 1 + below(random, std::min<std::size_t>(bytes.size() - from, 64));
  bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(from),
              bytes.begin() + static_cast<std::ptrdiff_t>(from + size));
}

Bytes mutated(Bytes bytes, Random& random) {
  for (std::size_t step = 1 + below(random, 4); step > 0 && !bytes.empty(); --step) {
    switch (below(random, 6)) {
      case 0:
        bytes[below(random, bytes.size())] ^= static_cast<unsigned char>(1u << below(random, 8));
        break;
      case 1:
        bytes[below(random, bytes.size())] = static_cast<unsigned char>(random());
        break;
      case 2:  // a digit for a digit, in texts
        if (unsigned char& c = bytes[below(random, bytes.size())]; c >= '0' && c <= '9')
          c = static_cast<unsigned char>('0' + below(random, 10));
        break;
      case 3:
        plant_number(bytes, random);
        break;
      case 4:
        copy_part(bytes, random);
        break;
      default:
        erase_part(bytes, random);
    }
  }
  return bytes;
}

class FuzzTargets : public testing::TestWithParam<const FuzzTarget*> {
 protected:
  const FuzzTarget& target_ = *GetParam();
};

TEST_P(FuzzTargets, EverySeedIsRead) {
  const std::vector<Bytes> seeds = target_.seeds();
  if (seeds.empty()) GTEST_SKIP() << "this build has no decoder for it";
  for (std::size_t i = 0; i < seeds.size(); ++i) EXPECT_EQ(feed(target_, seeds[i]), "") << i;
}

TEST_P(FuzzTargets, AnyMutationIsReadOrRefusedInOneSentence) {
  Random random(kSeed);
  std::size_t refused = 0, fed = 0;
  const std::vector<Bytes> seeds = target_.seeds();
  for (std::size_t i = 0; i < seeds.size(); ++i) {
    for (std::size_t turn = 0; turn < kMutationsPerSeed; ++turn, ++fed) {
      const Bytes bytes = mutated(seeds[i], random);
      try {
        refused += !feed(target_, bytes).empty();
      } catch (const std::exception& broken) {
        ADD_FAILURE() << "seed " << i << ", mutation " << turn << " of " << kSeed << ": "
                      << broken.what();
      }
    }
  }
  std::printf("%zu of %zu refused\n", refused, fed);
}

INSTANTIATE_TEST_SUITE_P(All, FuzzTargets,
                         testing::Values(&gltf_target(), &obj_target(), &mtl_target(),
                                         &ply_target(), &pc2_target(), &mdd_target(),
                                         &image_target(), &draco_target(), &meshopt_target(),
                                         &mdk_target(), &manifest_target()),
                         [](const auto& tested) { return std::string(tested.param->name); });

}  // namespace
}  // namespace mdk::test
