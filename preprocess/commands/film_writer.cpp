// Raw pictures go through a socket to ffmpeg's standard input; it writes the temporary file that
// AtomicFile renames. Threads are fixed and tags left out, so that the bytes are the same
// everywhere.
#include "preprocess/commands/film_writer.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <vector>

#include "common/base/error.h"
#include "preprocess/tool/text.h"

extern char** environ;

namespace mdk {
namespace {

struct Container {
  const char* extension;
  const char* format;
  const char* codec;
  const char* quality;
};
constexpr std::array<Container, 3> kContainers = {{{".mp4", "mp4", "libx264", "18"},
                                                   {".mkv", "matroska", "libx264", "18"},
                                                   {".webm", "webm", "libvpx-vp9", "24"}}};

const Container* container_of(const std::string& path) {
  for (const Container& container : kContainers)
    if (path.ends_with(container.extension)) return &container;
  return nullptr;
}

std::vector<std::string> ffmpeg_words(const Container& container, ImageSize size,
                                      double frames_per_second, const std::string& file) {
  return {"ffmpeg", "-hide_banner", "-loglevel", "error", "-y",
          // what comes in
          "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
          std::to_string(size.width) + "x" + std::to_string(size.height), "-r",
          fixed_text(frames_per_second, 6), "-i", "pipe:0",
          // what comes out: even sides, which 4:2:0 colour needs
          "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p", "-c:v", container.codec,
          "-crf", container.quality, "-b:v", "0", "-threads", "4", "-map_metadata", "-1", "-fflags",
          "+bitexact", "-flags:v", "+bitexact", "-f", container.format, "file:" + file};
}

void close_if_open(int& descriptor) {
  if (descriptor >= 0) ::close(descriptor);
  descriptor = -1;
}

}  // namespace

bool is_film(const std::string& path) { return container_of(path) != nullptr; }

FilmWriter::FilmWriter(const std::string& path, ImageSize size, double frames_per_second,
                       Overwrite overwrite)
    : path_(path), file_(path, overwrite) {
  start(size, frames_per_second);
}

void FilmWriter::start(ImageSize size, double frames_per_second) {
  int pictures[2];
  messages_ = memfd_create("ffmpeg-messages", MFD_CLOEXEC);
  if (messages_ < 0 || socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pictures) != 0) {
    close_if_open(messages_);
    throw io_error(path_, "cannot be written: no more files may be open");
  }
  pictures_ = pictures[0];
  std::vector<std::string> words =
      ffmpeg_words(*container_of(path_), size, frames_per_second, file_.temporary_path());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pictures[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, messages_, STDERR_FILENO);
  posix_spawnattr_t attributes;  // Ctrl-C is for us: we end it
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int failed = posix_spawnp(&process_, "ffmpeg", &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  ::close(pictures[1]);
  if (failed == 0) return;
  process_ = -1;
  close_if_open(pictures_);
  close_if_open(messages_);
  throw io_error(path_,
                 "a film needs the program ffmpeg, which is not installed; install it, or "
                 "write pictures, as in out_####.png");
}

FilmWriter::~FilmWriter() {
  close_if_open(pictures_);
  if (process_ > 0) {
    kill(process_, SIGKILL);
    wait_for_end();
  }
  close_if_open(messages_);
}

int FilmWriter::wait_for_end() {
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

void FilmWriter::fail() {
  close_if_open(pictures_);
  if (process_ > 0) wait_for_end();
  std::string words(200, '\0');
  const ssize_t got = ::pread(messages_, words.data(), words.size(), 0);
  words.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  words = words.substr(0, words.find('\n'));
  throw io_error(path_, "ffmpeg could not make it" + (words.empty() ? "" : " (" + words + ")") +
                            "; write pictures, as in out_####.png, and try by hand");
}

void FilmWriter::add(std::span<const std::uint32_t> pixels) {
  std::vector<unsigned char> rgb;
  rgb.reserve(pixels.size() * 3);
  for (const std::uint32_t pixel : pixels)
    for (const int shift : {0, 8, 16}) rgb.push_back(static_cast<unsigned char>(pixel >> shift));
  for (std::size_t sent = 0; sent < rgb.size();) {
    const ssize_t n = ::send(pictures_, rgb.data() + sent, rgb.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail();
    sent += static_cast<std::size_t>(n);
  }
}

void FilmWriter::finish() {
  close_if_open(pictures_);
  const int status = wait_for_end();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail();
  file_.commit();
}

}  // namespace mdk
