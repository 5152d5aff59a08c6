// The names of the sections of a .mdk file.
#include "formats/mdk/layout.h"

#include <string_view>

namespace mdk::layout {
namespace {

std::string_view mdk_section(std::uint32_t id) {
  for (const ModelArray& row : {kModel, kClips, kClipNames})
    if (row.id == id) return row.name;
  std::string_view found;
  const ModelView empty;
  ModelView::for_each_array(
      [&](const ModelArray& row, const auto&) {
        if (row.id == id) found = row.name;
      },
      empty);
  return found;
}

}  // namespace

const FileFormat kMdkFormat = {
    kMagic,          kMajorVersion, kMinorVersion, "an .mdk file", "bake one with mdprep bake",
    "bake it again", mdk_section};

}  // namespace mdk::layout
