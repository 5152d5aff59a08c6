// FilmWriter: pictures into a film, by ffmpeg as a child process, where that is installed.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <span>
#include <string>

#include "formats/files/atomic_file.h"
#include "preprocess/tool/shared_options.h"

namespace mdk {

/// Whether a file of this name is a film: it ends in .mp4, .mkv or .webm.
bool is_film(const std::string& path);

/// The film appears whole or not at all. The same pictures and the same ffmpeg give the same bytes.
class FilmWriter {
 public:
  /// Starts ffmpeg. Throws Error (kIo) where there is none, or the file cannot be written.
  FilmWriter(const std::string& path, ImageSize size, double frames_per_second,
             Overwrite overwrite);
  /// Ends ffmpeg and removes what it made unless finished.
  ~FilmWriter();
  FilmWriter(const FilmWriter&) = delete;
  FilmWriter& operator=(const FilmWriter&) = delete;

  /// width * height pixels as write_png takes them. Throws Error (kIo) where ffmpeg takes no more.
  void add(std::span<const std::uint32_t> pixels);

  /// Throws Error (kIo) where ffmpeg failed. Call once, last.
  void finish();

 private:
  void start(ImageSize size, double frames_per_second);
  int wait_for_end();
  [[noreturn]] void fail();

  std::string path_;
  AtomicFile file_;
  pid_t process_ = -1;
  int pictures_ = -1;  ///< a socket, so that an ffmpeg that is gone is an error, no signal
  int messages_ = -1;  ///< a file in memory, so that no length of them makes ffmpeg wait for us
};

}  // namespace mdk
