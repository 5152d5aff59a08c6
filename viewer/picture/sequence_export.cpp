#include "viewer/picture/sequence_export.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <utility>

#include "common/base/parallel.h"
#include "formats/atomic_file.h"
#include "viewer/picture/render_command.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr int kMostOutputs = 9999;

std::string numbered(const std::string& stem, int number, const char* ending) {
  char digits[16];
  std::snprintf(digits, sizeof digits, "-%04d", number);
  return stem + digits + ending;
}

Error no_free_name(const std::string& stem) {
  return {ErrorCode::kIo, stem + "-9999: all numbers are taken; move some of them away"};
}

/// A new folder for pictures, taken away again unless they are kept.
class PictureFolder {
 public:
  explicit PictureFolder(const std::string& stem) {
    for (int number = 1; number <= kMostOutputs; ++number) {
      std::error_code failure;
      path_ = numbered(stem + "-frames", number, "");
      if (fs::create_directory(path_, failure)) return;
      if (failure)
        throw Error(ErrorCode::kIo, path_ + ": cannot be made: " + failure.message() +
                                        "; start mdview in a folder you may write to");
    }
    throw no_free_name(stem + "-frames");
  }
  ~PictureFolder() {
    std::error_code ignored;
    if (!kept_) fs::remove_all(path_, ignored);
  }
  PictureFolder(const PictureFolder&) = delete;
  PictureFolder& operator=(const PictureFolder&) = delete;

  const std::string& path() const { return path_; }
  void keep() { kept_ = true; }

 private:
  std::string path_;
  bool kept_ = false;
};

std::string free_film_name(const std::string& stem) {
  for (int number = 1; number <= kMostOutputs; ++number) {
    std::error_code ignored;
    std::string name = numbered(stem, number, ".mp4");
    if (!fs::exists(fs::symlink_status(name, ignored))) return name;
  }
  throw no_free_name(stem);
}

/// The file a model was opened from, or a copy of it for a child to read: what was baked from a
/// source has no name any longer.
class ModelFile {
 public:
  explicit ModelFile(const MdkFile& file) : path_(file.path()) {
    std::error_code ignored;
    if (fs::exists(path_, ignored)) return;
    copy_folder_ = (fs::temp_directory_path() / "mdview-XXXXXX").string();
    if (!::mkdtemp(copy_folder_.data()))
      throw Error(ErrorCode::kIo, copy_folder_ + ": cannot be made");
    path_ = (fs::path(copy_folder_) / "model.mdk").string();
    AtomicFile copy(path_);
    copy.write(file.bytes());
    copy.commit();
  }
  ~ModelFile() {
    std::error_code ignored;
    if (!copy_folder_.empty()) fs::remove_all(copy_folder_, ignored);
  }
  ModelFile(const ModelFile&) = delete;
  ModelFile& operator=(const ModelFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path_, copy_folder_;
};

struct Cancelled {};

}  // namespace

KeyRange keys_within(const Model& model, std::uint32_t clip, double begin, double end) {
  const Clip& keys = model.clips[clip];
  const auto times = model.key_times.subspan(keys.first_key, keys.key_count);
  constexpr double kSlack = 1e-9;
  const auto first = std::lower_bound(times.begin(), times.end(), begin - kSlack);
  const auto after = std::upper_bound(times.begin(), times.end(), end + kSlack);
  if (first < after)
    return {keys.first_key + static_cast<std::uint32_t>(first - times.begin()),
            keys.first_key + static_cast<std::uint32_t>(after - times.begin()) - 1};
  const std::uint32_t near =
      keys.first_key + static_cast<std::uint32_t>(std::min<std::ptrdiff_t>(
                           first - times.begin(), static_cast<std::ptrdiff_t>(times.size()) - 1));
  return {near, near};
}

void SequenceExport::start(ExportOrder order) {
  if (busy_) return;
  if (thread_.joinable()) thread_.join();
  cancelled_ = false;
  busy_ = true;
  progress_ = MdprepProgress{};
  thread_ = std::thread([this, order = std::move(order), threads = thread_count()] {
    const ThreadLimit limit(threads);
    run(order);
  });
}

void SequenceExport::cancel() {
  {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    if (process_) process_->stop();
  }
  if (thread_.joinable()) thread_.join();
}

std::optional<MdprepProgress> SequenceExport::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

std::optional<ExportResult> SequenceExport::take_result() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, std::nullopt);
}

void SequenceExport::run(const ExportOrder& order) {
  ExportResult result;
  try {
    result.sentence = render(order);
  } catch (const Cancelled&) {
    result.sentence = "Export cancelled; nothing is left of it";
  } catch (const Error& error) {
    result.error = error;
  } catch (const std::exception& error) {
    result.error = Error(ErrorCode::kInternal, error.what());
  }
  {
    const std::lock_guard lock(mutex_);
    process_.reset();
    progress_.reset();
    result_ = std::move(result);
    busy_ = false;
  }
  on_news_();
}

std::string SequenceExport::render(const ExportOrder& order) {
  const ModelFile model(*order.picture.file);
  const std::string frames =
      std::to_string(order.keys.first) + ":" + std::to_string(order.keys.last);
  std::vector<std::string> arguments = {model.path(), "--frames", frames};
  const std::vector<std::string> how = render_options(order.picture);
  arguments.insert(arguments.end(), how.begin(), how.end());
  if (order.kind == ExportKind::kFilm) {
    const std::string name = free_film_name(order.stem);
    arguments.insert(arguments.end(), {"-o", name});
    wait_for(arguments);
    return "Exported " + name;
  }
  PictureFolder folder(order.stem);
  arguments.insert(arguments.end(), {"-o", folder.path() + "/" + order.stem + "_####.png"});
  wait_for(arguments);
  folder.keep();
  return "Exported " + std::to_string(order.keys.last - order.keys.first + 1) + " pictures to " +
         folder.path() + "/";
}

void SequenceExport::wait_for(const std::vector<std::string>& arguments) {
  const auto process = std::make_shared<MdprepProcess>("render", arguments);
  {
    const std::lock_guard lock(mutex_);
    process_ = process;
    if (cancelled_) process->stop();
  }
  while (auto news = process->next_progress()) {
    const std::lock_guard lock(mutex_);
    progress_ = *std::move(news);
    on_news_();
  }
  try {
    process->finish();
  } catch (const Error&) {
    const std::lock_guard lock(mutex_);
    if (cancelled_) throw Cancelled{};
    throw;
  }
}

bool can_export_films() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((fs::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

}  // namespace mdk
