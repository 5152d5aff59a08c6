// mmap of a whole file; the descriptor is not needed afterwards.
#include "formats/files/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <array>
#include <atomic>
#include <cerrno>  // program_invocation_short_name, too
#include <csignal>
#include <string_view>
#include <system_error>

#include "common/base/error.h"

namespace mdk {
namespace {

class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  ~Descriptor() {
    if (value_ >= 0) ::close(value_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return value_; }

 private:
  int value_;
};

Error cannot_read(const std::string& path, int error_number) {
  return io_error(path, "cannot be read: " + std::generic_category().message(error_number));
}

// The handler of bus errors may interrupt anything, malloc too: it finds the file's name in
// /proc/self/maps with nothing but system calls and its own stack.
//   7f12c0000000-7f12c8000000 r--p 00000000 08:01 4711    /films/cow.pc2

/// The lines of a file, one at a time, fit for a terminal; what does not fit into a line's room is
/// left out.
class Lines {
 public:
  explicit Lines(const char* path) : file_(::open(path, O_RDONLY | O_CLOEXEC)) {}
  ~Lines() {
    if (file_ >= 0) ::close(file_);
  }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  /// False at the end. What `line` shows lives until the next call.
  bool next(std::string_view& line) {
    std::size_t length = 0;
    for (;;) {
      if (at_ == filled_ && !fill()) break;
      const char c = block_[at_++];
      if (c == '\n') {
        line = {line_.data(), length};
        return true;
      }
      const bool is_control = static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
      if (length < line_.size()) line_[length++] = is_control ? '?' : c;
    }
    return false;
  }

 private:
  bool fill() {
    const ssize_t got = ::read(file_, block_.data(), block_.size());
    at_ = 0;
    filled_ = got > 0 ? static_cast<std::size_t>(got) : 0;
    return filled_ > 0;
  }

  int file_;
  std::array<char, 1024> block_{};
  std::array<char, 4096 + 128> line_{};
  std::size_t at_ = 0, filled_ = 0;
};

/// Takes a hexadecimal number and the character after it off the front.
std::uintptr_t take_hex(std::string_view& text) {
  std::uintptr_t value = 0;
  while (!text.empty()) {
    const char c = text.front();
    text.remove_prefix(1);
    if (c >= '0' && c <= '9')
      value = value * 16 + static_cast<std::uintptr_t>(c - '0');
    else if (c >= 'a' && c <= 'f')
      value = value * 16 + static_cast<std::uintptr_t>(c - 'a' + 10);
    else
      break;
  }
  return value;
}

/// The part of a line of /proc/self/maps that names a file, where the line's range holds `address`.
std::string_view file_at(std::string_view line, std::uintptr_t address) {
  const std::uintptr_t begin = take_hex(line), end = take_hex(line);
  if (address < begin || address >= end) return {};
  const std::size_t slash = line.find('/');
  return slash == std::string_view::npos ? std::string_view() : line.substr(slash);
}

void say(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

[[noreturn]] void say_and_exit(std::string_view file) {
  static std::atomic_flag said;
  if (said.test_and_set())
    for (;;) ::pause();                          // another thread is saying it
  if (::isatty(STDERR_FILENO)) say("\r\x1b[K");  // where a progress bar may stand
  say(program_invocation_short_name);
  say(": ");
  say(file);
  say(": was cut short, or its disk failed, while it was being read; run this again when nobody "
      "writes to it\n");
  ::_exit(static_cast<int>(ErrorCode::kIo));
}

void on_bus_error(int, siginfo_t* info, void*) {
  const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
  if (info->si_code == BUS_ADRERR) {
    Lines maps("/proc/self/maps");
    for (std::string_view line; maps.next(line);)
      if (const std::string_view file = file_at(line, address); !file.empty()) say_and_exit(file);
  }
  std::signal(SIGBUS, SIG_DFL);
  std::raise(SIGBUS);  // as soon as this returns
}

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  // O_NONBLOCK: opening a named pipe would otherwise wait for a writer.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.get() < 0) throw cannot_read(path, errno);
  struct stat status {};
  if (::fstat(file.get(), &status) != 0) throw cannot_read(path, errno);
  if (S_ISDIR(status.st_mode)) throw io_error(path, "cannot be read: it is a folder, not a file");
  if (!S_ISREG(status.st_mode)) throw io_error(path, "cannot be read: it is not a regular file");
  const auto size = static_cast<std::size_t>(status.st_size);
  if (size == 0) return;  // an empty mapping does not exist
  void* const memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (memory == MAP_FAILED) throw cannot_read(path, errno);
  bytes_ = {static_cast<const std::byte*>(memory), size};
}

MappedFile::~MappedFile() {
  if (!bytes_.empty()) {
    ::munmap(const_cast<void*>(static_cast<const void*>(bytes_.data())), bytes_.size());
  }
}

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
  return XXH3_64bits(bytes.data(), bytes.size());
}

void name_lost_mappings() {
  struct sigaction action {};
  action.sa_sigaction = on_bus_error;
  action.sa_flags = SA_SIGINFO;
  ::sigaction(SIGBUS, &action, nullptr);
}

}  // namespace mdk
