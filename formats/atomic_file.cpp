// Temporary name in the same folder (rename works within one file system only), O_EXCL so that two
// writers never share one, fsync before rename so that a power cut cannot leave a name without
// content.
#include "formats/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "common/base/error.h"

namespace mdk {
namespace {

constexpr int kMaxAttempts = 1000;
constexpr std::size_t kMaxWriteBytes = std::size_t{1}
                                       << 30;     // Linux moves no more than 2 GiB a call
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

}  // namespace

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
  const std::filesystem::path target(path);
  const std::string name = target.filename().string();
  if (name.empty()) throw io_error("'" + path + "'", "cannot be written: it names no file");
  refuse_bad_target(path);
  folder_ = target.has_parent_path() ? target.parent_path().string() : ".";

  std::string stem = ".";
  stem += name.substr(0, kMaxNameInTemporary) + ".tmp-" + std::to_string(::getpid()) + "-";
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    std::string candidate =
        (std::filesystem::path(folder_) / (stem + std::to_string(attempt))).string();
    descriptor_ = ::open(candidate.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ >= 0) {
      temporary_path_ = std::move(candidate);
      return;
    }
    const int error_number = errno;
    if (error_number != EEXIST) {
      throw io_error(path, "cannot be written: folder '" + folder_ + "': " + reason(error_number));
    }
  }
  throw io_error(path, "cannot be written: folder '" + folder_ +
                           "' is full of temporary files named '" + stem + "…'; remove them");
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

void AtomicFile::commit() {
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

}  // namespace mdk
