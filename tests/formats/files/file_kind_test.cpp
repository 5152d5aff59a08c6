// What a name's extension says.
#include "formats/files/file_kind.h"

#include <gtest/gtest.h>

#include <set>

namespace mdk::test {
namespace {

TEST(FileKind, IsKnownByTheExtensionInAnyCase) {
  EXPECT_EQ(file_kind("a/hand.mdk"), FileKind::kBaked);
  EXPECT_EQ(file_kind("HAND.GLB"), FileKind::kGltf);
  EXPECT_EQ(file_kind("walk.Md5Mesh"), FileKind::kForAssimp);
  EXPECT_EQ(file_kind("cow.obj"), FileKind::kMesh);
  EXPECT_EQ(file_kind("cow.obj.pc2"), FileKind::kPointCache);
  for (const char* name : {"", "mdk", ".mdk", "a.mdk/b", "notes.txt", "hand.glb~", "hand."})
    EXPECT_EQ(file_kind(name), FileKind::kOther) << name;
}

TEST(FileKind, EachExtensionIsOfOneKindAndLeadsBackToIt) {
  std::set<std::string_view> seen;
  for (const FileKind kind : {FileKind::kBaked, FileKind::kGltf, FileKind::kForAssimp,
                              FileKind::kMesh, FileKind::kPointCache}) {
    EXPECT_FALSE(extensions_of(kind).empty());
    for (const std::string_view extension : extensions_of(kind)) {
      EXPECT_TRUE(seen.insert(extension).second) << extension;
      const std::string name = std::string("x").append(extension);
      EXPECT_EQ(file_kind(name), kind) << extension;
      EXPECT_EQ(lower_extension(name), extension);
    }
  }
  EXPECT_TRUE(extensions_of(FileKind::kOther).empty());
}

}  // namespace
}  // namespace mdk::test
