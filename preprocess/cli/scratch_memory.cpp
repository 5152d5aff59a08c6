// The global operator new is replaced: vectors of every room ask it, and none of them need know. A
// block from a file is known by its address, which starts a page; malloc's never do.
#include "preprocess/cli/scratch_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <new>

namespace mdk {
namespace {

constexpr std::size_t kMostBlocks = 256;
constexpr std::uintptr_t kPageBytes = 4096;

struct Block {
  void* start = nullptr;
  std::size_t size = 0;
};

/// What operator new has to go by; it can be handed nothing, and must not allocate.
struct Blocks {
  std::mutex mutex;
  std::array<Block, kMostBlocks> list{};
  std::size_t bytes = 0, peak_bytes = 0;
  std::array<char, 4096> folder{};
  std::atomic<std::size_t> smallest{0};  ///< 0: none is large
  std::atomic<std::size_t> count{0};
};
constinit Blocks blocks;

/// An unlinked file of so many bytes, all of them on the disk: a hole that cannot be filled later
/// would end the process. Negative where there is none.
int open_scratch(std::size_t size) {
  const int file = ::open(blocks.folder.data(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file < 0) return file;
  if (::posix_fallocate(file, 0, static_cast<off_t>(size)) == 0) return file;
  ::close(file);
  return -1;
}

void* map_block(std::size_t size) {
  const std::lock_guard lock(blocks.mutex);
  const auto free = std::ranges::find(blocks.list, nullptr, &Block::start);
  if (free == blocks.list.end()) return nullptr;
  const int file = open_scratch(size);
  if (file < 0) return nullptr;
  void* const start = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  if (start == MAP_FAILED) return nullptr;
  *free = {start, size};
  blocks.bytes += size;
  blocks.peak_bytes = std::max(blocks.peak_bytes, blocks.bytes);
  ++blocks.count;
  return start;
}

bool unmap_block(void* start) {
  if (blocks.count == 0 || reinterpret_cast<std::uintptr_t>(start) % kPageBytes != 0) return false;
  const std::lock_guard lock(blocks.mutex);
  const auto block = std::ranges::find(blocks.list, start, &Block::start);
  if (start == nullptr || block == blocks.list.end()) return false;
  ::munmap(block->start, block->size);
  blocks.bytes -= block->size;
  *block = {};
  --blocks.count;
  return true;
}

}  // namespace

ScratchMemory::ScratchMemory(const std::string& folder, std::uint64_t smallest_block) {
  std::error_code problem;
  const std::string whole =
      std::filesystem::absolute(folder.empty() ? "." : folder, problem).string();
  if (problem || whole.size() >= blocks.folder.size()) return;
  const std::lock_guard lock(blocks.mutex);
  *std::ranges::copy(whole, blocks.folder.begin()).out = '\0';
  blocks.smallest = smallest_block;
}

ScratchMemory::~ScratchMemory() { blocks.smallest = 0; }

std::uint64_t ScratchMemory::peak_bytes() {
  const std::lock_guard lock(blocks.mutex);
  return blocks.peak_bytes;
}

}  // namespace mdk

void* operator new(std::size_t size) {
  const std::size_t smallest = mdk::blocks.smallest;
  if (smallest != 0 && size >= smallest)
    if (void* const block = mdk::map_block(size)) return block;
  for (;;) {
    if (void* const memory = std::malloc(std::max<std::size_t>(size, 1))) return memory;
    const std::new_handler handler = std::get_new_handler();
    if (!handler) throw std::bad_alloc();
    handler();
  }
}

void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  try {
    return operator new(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

void operator delete(void* memory) noexcept {
  if (!mdk::unmap_block(memory)) std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }
