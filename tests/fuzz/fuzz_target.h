// FuzzTarget: a reader that must survive any bytes, and the files it is meant for to start from.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "tests/formats/temp_folder.h"

namespace mdk::test {

struct FuzzTarget {
  const char* name;
  void (*read)(std::span<const unsigned char> bytes);  ///< may throw Error; nothing else
  std::vector<Bytes> (*seeds)();                       ///< small files that are read
};

const FuzzTarget& gltf_target();
const FuzzTarget& obj_target();
const FuzzTarget& mtl_target();
const FuzzTarget& ply_target();
const FuzzTarget& pc2_target();
const FuzzTarget& mdd_target();
const FuzzTarget& image_target();
const FuzzTarget& draco_target();    ///< no seeds where Draco was not there at build time
const FuzzTarget& meshopt_target();  ///< no seeds where meshoptimizer was not there
const FuzzTarget& mdk_target();
const FuzzTarget& manifest_target();

/// Feeds the bytes to the reader. Empty where they were read; the sentence where they were refused.
/// Throws std::logic_error where the reader broke its promise: another exception, a refusal as
/// a bug or wrong use, or one that goes on for pages.
std::string feed(const FuzzTarget& target, std::span<const unsigned char> bytes);

/// A file that holds one input after another, in a temporary folder of its own.
class FuzzFile {
 public:
  explicit FuzzFile(const std::string& name);
  ~FuzzFile();
  FuzzFile(const FuzzFile&) = delete;
  FuzzFile& operator=(const FuzzFile&) = delete;

  const std::string& holding(std::span<const unsigned char> bytes);

 private:
  TempFolder folder_;
  std::string path_;
  int descriptor_;  ///< kept open: some file systems write out what is closed
};

Bytes bytes_of(const std::string& text);

}  // namespace mdk::test
