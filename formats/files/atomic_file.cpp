// Temporary name in the same folder (rename works within one file system only), O_EXCL so that two
// writers never share one, fsync before rename so that a power cut cannot leave a name without
// content. The writer holds a lock on it: whoever gets that lock knows that the writer is gone.
#include "formats/files/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "common/base/error.h"

namespace mdk {
namespace {

constexpr int kMaxAttempts = 1000;
constexpr std::size_t kMaxWriteBytes = std::size_t{1}
                                       << 30;     // Linux moves no more than 2 GiB a call
constexpr std::string_view kMark = ".tmp-";       // then the process and a number
constexpr std::size_t kMaxNameInTemporary = 200;  // file names end at 255 bytes

std::string reason(int error_number) { return std::generic_category().message(error_number); }

/// Before the work that is to be written, where rename would find out after it.
void refuse_bad_target(const std::string& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    const int error_number = errno;
    if (error_number == ENOENT) return;
    throw io_error(path, "cannot be written: " + reason(error_number));
  }
  if (S_ISDIR(status.st_mode)) {
    throw io_error(path, "cannot be written: it is a folder; name a file in it");
  }
  if (!S_ISREG(status.st_mode)) {
    throw io_error(path,
                   "cannot be written: it is not a regular file, and would be replaced by one");
  }
}

/// Best effort where the folder or its file system cannot do it: the content is safe by then, only
/// which of the two files the name means after a power cut is open.
void sync_folder(const std::string& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

/// As many bytes as fit, fewer only at the end of the file; none where it cannot be read.
std::size_t read_block(int descriptor, std::span<std::byte> block) {
  std::size_t filled = 0;
  while (filled < block.size()) {
    const ssize_t got = ::read(descriptor, block.data() + filled, block.size() - filled);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return 0;
    if (got == 0) break;
    filled += static_cast<std::size_t>(got);
  }
  return filled;
}

bool is_gone(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && status.st_nlink == 0;
}

/// ".out.mdk.tmp-4711-0"
bool is_temporary_name(std::string_view name) {
  const std::size_t mark = name.rfind(kMark);
  if (mark == std::string_view::npos || mark < 2 || name.front() != '.') return false;
  const std::string_view numbers = name.substr(mark + kMark.size());
  const std::size_t dash = numbers.find('-');
  return dash != 0 && dash < numbers.size() - 1 &&
         numbers.find_first_not_of("0123456789-") == std::string_view::npos;
}

bool remove_if_abandoned(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return false;
  const bool removed = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && !is_gone(descriptor) &&
                       ::unlink(path.c_str()) == 0;
  ::close(descriptor);
  return removed;
}

}  // namespace

AtomicFile::AtomicFile(const std::string& path, Overwrite overwrite)
    : path_(path), overwrite_(overwrite) {
  const std::filesystem::path target(path);
  const std::string name = target.filename().string();
  if (name.empty()) throw io_error("'" + path + "'", "cannot be written: it names no file");
  refuse_bad_target(path);
  folder_ = target.has_parent_path() ? target.parent_path().string() : ".";

  std::string stem = ".";
  stem +=
      name.substr(0, kMaxNameInTemporary) + std::string(kMark) + std::to_string(::getpid()) + "-";
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    std::string candidate =
        (std::filesystem::path(folder_) / (stem + std::to_string(attempt))).string();
    if (create(candidate)) return;
  }
  throw io_error(path, "cannot be written: folder '" + folder_ +
                           "' is full of temporary files named '" + stem + "…'; remove them");
}

bool AtomicFile::create(const std::string& candidate) {
  const int descriptor = ::open(candidate.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    const int error_number = errno;
    if (error_number == EEXIST) return false;
    throw io_error(path_, "cannot be written: folder '" + folder_ + "': " + reason(error_number));
  }
  // Between the two calls someone may have taken it for abandoned. A file system without locks
  // refuses both sides alike.
  if (::flock(descriptor, LOCK_EX) == 0 && is_gone(descriptor)) {
    ::close(descriptor);
    return false;
  }
  descriptor_ = descriptor;
  temporary_path_ = candidate;
  return true;
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!temporary_path_.empty()) ::unlink(temporary_path_.c_str());
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written =
        ::write(descriptor_, bytes.data(), std::min(bytes.size(), kMaxWriteBytes));
    if (written < 0) {
      if (errno == EINTR) continue;
      throw io_error(path_, "cannot be written: " + reason(errno));
    }
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

bool AtomicFile::old_file_is_equal() const {
  const int old = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
  if (old < 0) return false;
  struct stat old_status {
  }, new_status{};
  bool equal = ::fstat(old, &old_status) == 0 && ::fstat(descriptor_, &new_status) == 0 &&
               old_status.st_size == new_status.st_size && ::lseek(descriptor_, 0, SEEK_SET) == 0;
  std::vector<std::byte> old_block(std::size_t{1} << 20), new_block(old_block.size());
  for (off_t left = old_status.st_size; equal && left > 0;) {
    const std::size_t got = read_block(old, old_block);
    equal = got > 0 && got == read_block(descriptor_, new_block) &&
            std::equal(old_block.begin(), old_block.begin() + static_cast<std::ptrdiff_t>(got),
                       new_block.begin());
    left -= static_cast<off_t>(got);
  }
  ::close(old);
  return equal;
}

void AtomicFile::commit() {
  if (overwrite_ == Overwrite::kIfChanged && old_file_is_equal()) {
    ::unlink(temporary_path_.c_str());
    temporary_path_.clear();
    return;
  }
  if (::fsync(descriptor_) != 0) throw io_error(path_, "cannot be written: " + reason(errno));
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) throw io_error(path_, "cannot be written: " + reason(errno));
  if (::rename(temporary_path_.c_str(), path_.c_str()) != 0) {
    throw io_error(path_, "cannot take its name: " + reason(errno));
  }
  temporary_path_.clear();
  sync_folder(folder_);
}

std::size_t remove_abandoned_temporaries(const std::string& folder) {
  std::size_t removed = 0;
  std::error_code problem;
  std::filesystem::directory_iterator entry(folder, problem);
  for (; !problem && entry != std::filesystem::directory_iterator(); entry.increment(problem)) {
    if (is_temporary_name(entry->path().filename().native()))
      removed += remove_if_abandoned(entry->path().string());
  }
  return removed;
}

}  // namespace mdk
