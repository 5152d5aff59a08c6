// MdprepProcess: mdprep at work in a process of its own: no file, however bad, can end the viewer,
// and work can be dropped at any moment. TemporaryFolder: for files that only the two of them know.
#pragma once

#include <sys/types.h>

#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace mdk {

struct MdprepProgress {
  double fraction = 0;  ///< of the whole, in [0, 1]
  std::string text;     ///< " 42 %  decompose, 0:12 left"
};

class MdprepProcess {
 public:
  /// Starts "mdprep SUBCOMMAND --progress always ARGUMENTS", with the mdprep beside this program or
  /// else the one in the path, at a low priority. Throws Error (kIo) where it cannot be started.
  MdprepProcess(const std::string& subcommand, const std::vector<std::string>& arguments);
  /// Kills it, if need be.
  ~MdprepProcess();
  MdprepProcess(const MdprepProcess&) = delete;
  MdprepProcess& operator=(const MdprepProcess&) = delete;

  /// Waits for news; nothing when there will be none.
  std::optional<MdprepProgress> next_progress();

  /// After the last news: returns where its work is done, throws Error with mdprep's own
  /// sentence where it does not.
  void finish();

  /// From any thread: it ends at once.
  void kill();
  /// From any thread: it ends as soon as it has taken away what it had begun to write.
  void stop();

 private:
  void send(int signal_number);
  std::optional<MdprepProgress> take_line(std::string_view line);

  std::mutex mutex_;  // of pid_
  pid_t pid_ = -1;
  int messages_ = -1;     // reading end of its stderr
  std::string unread_;    // the start of a line
  std::string sentence_;  // the last that was no progress
};

/// What a piece of mdprep's stderr says of progress: "[####----]  42 %  build"; else nothing.
std::optional<MdprepProgress> parse_mdprep_progress(std::string_view line);

/// A new folder for temporary files, taken away at the end.
class TemporaryFolder {
 public:
  /// Throws Error (kIo) where it cannot be made.
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string file(const std::string& name) const;

 private:
  std::string path_;
};

}  // namespace mdk
