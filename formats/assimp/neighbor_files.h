// The files Assimp may open: the input and what stands beside it, to read.
#pragma once

#include <assimp/IOSystem.hpp>
#include <string>
#include <vector>

namespace mdk {

/// Assimp sees the input's folder as all there is: names that lead out of it do not exist, and
/// nothing is ever written.
class NeighborFiles final : public Assimp::IOSystem {
 public:
  explicit NeighborFiles(std::string input) : input_(std::move(input)) {}

  bool Exists(const char* name) const override;
  char getOsSeparator() const override { return '/'; }
  /// The whole file, read at once; null where it cannot be, or is to be written.
  Assimp::IOStream* Open(const char* name, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

  /// Paths of all that were opened, each once.
  const std::vector<std::string>& opened() const { return opened_; }

 private:
  std::string path_of(const char* name) const;

  std::string input_;
  std::vector<std::string> opened_;
};

}  // namespace mdk
