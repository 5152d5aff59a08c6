#include "tests/formats/mdk/mdk_image.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <stdexcept>

#include "formats/files/mapped_file.h"

namespace mdk::test {
namespace {

constexpr std::size_t kFileSizeAt = 16, kSectionCountAt = 24, kChecksumAt = 56;

std::size_t round_up(std::size_t offset) { return (offset + 63) / 64 * 64; }

void put_entry(Bytes& file, std::size_t at, const ImageSection& section) {
  std::memcpy(file.data() + at, section.id.data(), 4);
  put(file, at + 4, section.flags);
  put(file, at + 8, section.element_bytes);
  put(file, at + 12, std::uint32_t{0});
  put(file, at + 16, section.element_count);
  put(file, at + 24, section.offset);
  put(file, at + 32, section.checksum);
}

}  // namespace

template <class T>
T get(const Bytes& bytes, std::size_t at) {
  T value;
  if (at > bytes.size() || sizeof(T) > bytes.size() - at) throw std::out_of_range("get");
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  return value;
}

template <class T>
void put(Bytes& bytes, std::size_t at, T value) {
  if (at > bytes.size() || sizeof(T) > bytes.size() - at) throw std::out_of_range("put");
  std::memcpy(bytes.data() + at, &value, sizeof(T));
}

template std::uint16_t get(const Bytes&, std::size_t);
template std::uint32_t get(const Bytes&, std::size_t);
template std::uint64_t get(const Bytes&, std::size_t);
template float get(const Bytes&, std::size_t);
template double get(const Bytes&, std::size_t);
template void put(Bytes&, std::size_t, std::uint16_t);
template void put(Bytes&, std::size_t, std::uint32_t);
template void put(Bytes&, std::size_t, std::uint64_t);
template void put(Bytes&, std::size_t, float);
template void put(Bytes&, std::size_t, double);

std::vector<ImageSection> read_table(const Bytes& file) {
  std::vector<ImageSection> table(get<std::uint32_t>(file, kSectionCountAt));
  for (std::size_t i = 0; i < table.size(); ++i) {
    const std::size_t at = kHeaderBytes + i * kEntryBytes;
    table[i].id = std::string(file.begin() + static_cast<std::ptrdiff_t>(at),
                              file.begin() + static_cast<std::ptrdiff_t>(at + 4));
    table[i].flags = get<std::uint32_t>(file, at + 4);
    table[i].element_bytes = get<std::uint32_t>(file, at + 8);
    table[i].element_count = get<std::uint64_t>(file, at + 16);
    table[i].offset = get<std::uint64_t>(file, at + 24);
    table[i].checksum = get<std::uint64_t>(file, at + 32);
  }
  return table;
}

std::size_t entry_offset(const Bytes& file, const std::string& id) {
  const auto table = read_table(file);
  for (std::size_t i = 0; i < table.size(); ++i) {
    if (table[i].id == id) return kHeaderBytes + i * kEntryBytes;
  }
  throw std::out_of_range("no section " + id);
}

ImageSection find_section(const Bytes& file, const std::string& id) {
  return read_table(file)[(entry_offset(file, id) - kHeaderBytes) / kEntryBytes];
}

void seal(Bytes& file) {
  const std::size_t table_bytes =
      std::size_t{get<std::uint32_t>(file, kSectionCountAt)} * kEntryBytes;
  Bytes covered(file.begin(), file.begin() + kChecksumAt);
  if (table_bytes > file.size() - kHeaderBytes) return;  // no such table: nothing to seal
  covered.insert(covered.end(), file.begin() + kHeaderBytes,
                 file.begin() + static_cast<std::ptrdiff_t>(kHeaderBytes + table_bytes));
  put(file, kChecksumAt, checksum_of(std::as_bytes(std::span(covered))));
}

Bytes with_section(const Bytes& file, const ImageSection& section, const Bytes& content) {
  std::vector<ImageSection> table = read_table(file);
  const std::size_t old_start = round_up(kHeaderBytes + table.size() * kEntryBytes);
  const std::size_t new_start = round_up(kHeaderBytes + (table.size() + 1) * kEntryBytes);
  Bytes longer(new_start, 0);
  std::copy_n(file.begin(), kHeaderBytes, longer.begin());
  longer.insert(longer.end(), file.begin() + static_cast<std::ptrdiff_t>(old_start), file.end());
  for (ImageSection& old : table) old.offset += new_start - old_start;
  table.push_back(section);
  table.back().offset = longer.size();
  longer.insert(longer.end(), content.begin(), content.end());
  longer.resize(round_up(longer.size()), 0);
  for (std::size_t i = 0; i < table.size(); ++i) {
    put_entry(longer, kHeaderBytes + i * kEntryBytes, table[i]);
  }
  put(longer, kFileSizeAt, static_cast<std::uint64_t>(longer.size()));
  put(longer, kSectionCountAt, static_cast<std::uint32_t>(table.size()));
  seal(longer);
  return longer;
}

}  // namespace mdk::test
