// BakeProcess: mdprep at work on a source file, in a process of its own: no source, however bad,
// can end the viewer, and a bake can be dropped at any moment.
#pragma once

#include <sys/types.h>

#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace mdk {

struct BakeProgress {
  double fraction = 0;  ///< of the whole bake, in [0, 1]
  std::string text;     ///< " 42 %  decompose, 0:12 left"
};

class BakeProcess {
 public:
  /// Starts `mdprep bake INPUTS -o OUTPUT`, with the mdprep beside this program or else the one in
  /// the path. Throws Error (kIo) where it cannot be started.
  BakeProcess(const std::vector<std::string>& inputs, const std::string& output);
  /// Kills it, if need be.
  ~BakeProcess();
  BakeProcess(const BakeProcess&) = delete;
  BakeProcess& operator=(const BakeProcess&) = delete;

  /// Waits for news; nothing when there will be none.
  std::optional<BakeProgress> next_progress();

  /// After the last news: returns where the output stands whole, throws Error with mdprep's own
  /// sentence where it does not.
  void finish();

  /// From any thread: it ends at once.
  void kill();

 private:
  std::optional<BakeProgress> take_line(std::string_view line);

  std::mutex mutex_;  // of pid_
  pid_t pid_ = -1;
  int messages_ = -1;     // reading end of its stderr
  std::string unread_;    // the start of a line
  std::string sentence_;  // the last that was no progress
};

/// What a piece of mdprep's stderr says of progress: "[####----]  42 %  build"; else nothing.
std::optional<BakeProgress> parse_bake_progress(std::string_view line);

}  // namespace mdk
