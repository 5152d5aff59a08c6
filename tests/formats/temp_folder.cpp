#include "tests/formats/temp_folder.h"

#include <stdlib.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace mdk::test {

TempFolder::TempFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "mdk-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> TempFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

namespace {

template <class Whole>
Whole read_whole(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_whole(const std::string& path, const char* data, std::size_t size) {
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out.write(data, static_cast<std::streamsize>(size));
  if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace

Bytes read_bytes(const std::string& path) { return read_whole<Bytes>(path); }

void write_bytes(const std::string& path, const Bytes& bytes) {
  write_whole(path, reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

std::string read_text(const std::string& path) { return read_whole<std::string>(path); }

void write_text(const std::string& path, const std::string& text) {
  write_whole(path, text.data(), text.size());
}

}  // namespace mdk::test
