#include "preprocess/cli/text_file.h"

#include <span>

#include "common/base/error.h"
#include "formats/atomic_file.h"
#include "formats/mapped_file.h"

namespace mdk {

void write_text_file(const std::string& path, std::string_view text) {
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(text.data(), text.size())));
  file.commit();
}

std::string read_text_file(const std::string& path, std::size_t limit) {
  const MappedFile file(path);
  const std::span<const std::byte> bytes = file.bytes();
  if (bytes.size() > limit)
    throw Error(ErrorCode::kOverLimit, path + ": is larger than the " + std::to_string(limit) +
                                           " bytes that such a file may have");
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace mdk
