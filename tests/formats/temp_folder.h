// TempFolder: a folder of its own for one test, and whole files in and out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace mdk::test {

using Bytes = std::vector<unsigned char>;

/// Removed with everything in it at the end.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  std::string path() const { return path_.string(); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  /// Names of everything in it, sorted.
  std::vector<std::string> names() const;

 private:
  std::filesystem::path path_;
};

Bytes read_bytes(const std::string& path);
void write_bytes(const std::string& path, const Bytes& bytes);
std::string read_text(const std::string& path);
void write_text(const std::string& path, const std::string& text);

}  // namespace mdk::test
