// A large block is a mapping, of an unlinked file or, where there is none, of memory; so its size
// alone says how to free it.
#include "common/base/scratch.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>

namespace mdk {
namespace {

/// An unlinked file of so many bytes, all of them on the disk: a hole that cannot be filled later
/// would end the process. Negative where there is none.
int open_scratch(const std::string& folder, std::size_t bytes) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) return file;
  if (::posix_fallocate(file, 0, static_cast<off_t>(bytes)) == 0) return file;
  ::close(file);
  return -1;
}

/// Null where there is no such file.
void* map_file(const std::string& folder, std::size_t bytes) {
  const int file = open_scratch(folder, bytes);
  if (file < 0) return nullptr;
  void* const start = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  return start == MAP_FAILED ? nullptr : start;
}

void* map_memory(std::size_t bytes) {
  void* const start =
      ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (start == MAP_FAILED) throw std::bad_alloc();
  return start;
}

}  // namespace

struct ScratchSpace::State {
  std::string folder;
  std::size_t min_bytes = 0;
  std::mutex mutex;
  std::map<const void*, std::size_t> files;  ///< blocks that stand in files, and their bytes
  std::uint64_t bytes = 0, peak_bytes = 0;

  void add(const void* start, std::size_t size) {
    const std::lock_guard lock(mutex);
    files.emplace(start, size);
    bytes += size;
    peak_bytes = std::max(peak_bytes, bytes);
  }
  void remove(const void* start) {
    const std::lock_guard lock(mutex);
    const auto file = files.find(start);
    if (file == files.end()) return;
    bytes -= file->second;
    files.erase(file);
  }
};

ScratchSpace::ScratchSpace(const std::string& folder, std::uint64_t min_bytes) {
  std::error_code problem;
  const auto whole = std::filesystem::absolute(folder.empty() ? "." : folder, problem);
  if (problem || min_bytes == 0) return;
  state_ = std::make_shared<State>();
  state_->folder = whole.string();
  state_->min_bytes = min_bytes;
}

std::uint64_t ScratchSpace::peak_bytes() const {
  if (!state_) return 0;
  const std::lock_guard lock(state_->mutex);
  return state_->peak_bytes;
}

void* ScratchSpace::allocate(std::size_t bytes) const {
  if (!state_ || bytes < state_->min_bytes) return ::operator new(bytes);
  void* const start = map_file(state_->folder, bytes);
  if (!start) return map_memory(bytes);
  state_->add(start, bytes);
  return start;
}

void ScratchSpace::free(void* memory, std::size_t bytes) const noexcept {
  if (!state_ || bytes < state_->min_bytes) {
    ::operator delete(memory);
  } else {
    state_->remove(memory);
    ::munmap(memory, bytes);
  }
}

}  // namespace mdk
