// ScratchSpace: where large lists stand instead of in memory, so that a long sequence needs no
// memory of its own size: in files on a disk, of which the system keeps in memory what is in use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace mdk {

/// Handed by value to whoever makes large lists; copies are the same space. The one made without
/// arguments means memory.
class ScratchSpace {
 public:
  ScratchSpace() = default;
  /// Lists of at least `min_bytes` stand in files in `folder` that have no name: nothing can be
  /// left behind, however the process ends. They do not count for a limit of the process's private
  /// memory. Where the folder has no room, or its file system no such files, a list stands in
  /// memory all the same. 0 bytes: no list is large.
  ScratchSpace(const std::string& folder, std::uint64_t min_bytes);

  /// The most bytes that ever stood in files at once.
  std::uint64_t peak_bytes() const;

  /// Throws std::bad_alloc. Any thread may allocate and free.
  void* allocate(std::size_t bytes) const;
  void free(void* memory, std::size_t bytes) const noexcept;

  bool operator==(const ScratchSpace&) const = default;

 private:
  struct State;
  std::shared_ptr<State> state_;  ///< null: memory
};

/// What makes a std::vector stand in a scratch space. It goes with the elements when a list is
/// moved, and is copied with them.
template <class T>
class ScratchAllocator {
 public:
  using value_type = T;
  using propagate_on_container_copy_assignment = std::true_type;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;

  ScratchAllocator() = default;
  ScratchAllocator(const ScratchSpace& space) : space_(space) {}
  template <class U>
  ScratchAllocator(const ScratchAllocator<U>& other) : space_(other.space()) {}

  T* allocate(std::size_t count) { return static_cast<T*>(space_.allocate(count * sizeof(T))); }
  void deallocate(T* memory, std::size_t count) noexcept { space_.free(memory, count * sizeof(T)); }

  ScratchSpace space() const { return space_; }
  bool operator==(const ScratchAllocator&) const = default;

 private:
  ScratchSpace space_;
};

/// A std::vector that a space may be given to: `ScratchList<Vec3f> list(space);`
template <class T>
using ScratchList = std::vector<T, ScratchAllocator<T>>;

}  // namespace mdk
