#include "preprocess/cli/text_file.h"

#include <span>

#include "formats/atomic_file.h"

namespace mdk {

void write_text_file(const std::string& path, std::string_view text) {
  AtomicFile file(path);
  file.write(std::as_bytes(std::span(text.data(), text.size())));
  file.commit();
}

}  // namespace mdk
