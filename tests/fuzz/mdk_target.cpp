// .mdk images: what opening lets through is posed and traced by one of the techniques.
#include <numeric>
#include <string_view>

#include "common/trace/renderer.h"
#include "formats/mdk/mdk_file.h"
#include "formats/mdk/writer.h"
#include "tests/formats/mdk/mdk_image.h"
#include "tests/formats/mdk/sample_model.h"
#include "tests/fuzz/fuzz_target.h"

namespace mdk::test {
namespace {

constexpr std::uint32_t kSide = 12;

/// Alike for the same bytes, so that a finding can be found again.
std::size_t choice(std::span<const unsigned char> bytes, std::size_t count) {
  return std::accumulate(bytes.begin(), bytes.end(), std::size_t{0}) % count;
}

void render(const ModelView& model, std::size_t turn) {
  const std::span<const TechniqueInfo> techniques = technique_table();
  const std::span<const ShadingInfo> shadings = shading_table();
  const Clip& clip = model.clips.front();
  const std::uint32_t next = clip.key_count > 1 ? clip.first_key + 1 : clip.first_key;
  Renderer renderer(model, techniques[turn % techniques.size()].id);
  renderer.render({.at = model.holds_between_keys ? KeyInterval{clip.first_key, next, 0.25f}
                                                  : at_key(clip.first_key),
                   .camera = fit_camera({{0, 0, 0}, {2, 5, 2}}, 1.0),
                   .width = kSide,
                   .height = kSide,
                   .shading = shadings[turn % shadings.size()].mode});
}

/// The table's checksum is made right first: no mutation could guess it.
void read_mdk(std::span<const unsigned char> bytes) {
  static FuzzFile holder("a.mdk");
  Bytes sealed(bytes.begin(), bytes.end());
  if (sealed.size() >= kHeaderBytes) seal(sealed);
  const MdkFile file(holder.holding(sealed));
  // Each list in a block of its own, where AddressSanitizer sees one step outside.
  const ModelStorage copy = copy_of(file.model());
  render(copy.view(), choice(bytes, 1 << 16));
  file.verify_checksums();
}

Bytes file_of(const ModelStorage& model) {
  const TempFolder folder;
  write_mdk(model.view(), folder.file("a.mdk"));
  return read_bytes(folder.file("a.mdk"));
}

}  // namespace

const FuzzTarget& mdk_target() {
  static const FuzzTarget target = {"mdk", read_mdk, [] {
                                      return std::vector<Bytes>{file_of(sample_model()),
                                                                file_of(sample_rig_model()),
                                                                file_of(sample_quantized_model()),
                                                                file_of(sample_skeleton_model())};
                                    }};
  return target;
}

}  // namespace mdk::test
