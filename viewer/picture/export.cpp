#include "viewer/picture/export.h"

#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <utility>

#include "common/base/error.h"
#include "common/trace/technique.h"
#include "formats/files/atomic_file.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

/// The shortest text that reads back as the same number.
template <class Number>
std::string exact_text(Number value) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string camera_text(const Camera& c) {
  std::string text;
  for (const float value :
       {c.eye.x, c.eye.y, c.eye.z, c.target.x, c.target.y, c.target.z, c.up.x, c.up.y, c.up.z})
    text += exact_text(value) + " ";
  return text + exact_text(c.vertical_fov_deg);
}

/// "STEM-0001ENDING", or the first number for which `is_free`. Throws Error (kIo) where none is.
template <class IsFree>
std::string numbered_name(const std::string& stem, const std::string& ending, IsFree is_free) {
  for (int number = 1; number < 10000; ++number) {
    std::string digits = std::to_string(number);
    digits.insert(0, 4 - digits.size(), '0');
    std::string name = stem + "-" + digits + ending;
    if (is_free(name)) return name;
  }
  throw io_error(stem + "-9999" + ending, "all numbers are taken; move some of them away");
}

bool is_no_file(const std::string& name) {
  std::error_code ignored;
  return !fs::exists(fs::symlink_status(name, ignored));
}

/// A new folder for pictures, taken away again unless they are kept.
class PictureFolder {
 public:
  explicit PictureFolder(const std::string& stem) {
    path_ = numbered_name(stem + "-frames", "", [](const std::string& name) {
      std::error_code failure;
      const bool is_new = fs::create_directory(name, failure);
      if (failure)
        throw io_error(name, "cannot be made: " + failure.message() +
                                 "; start mdview in a folder you may write to");
      return is_new;
    });
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

}  // namespace

std::string free_picture_name(const std::string& stem) {
  return numbered_name(stem, ".png", is_no_file);
}

std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+:@%,";
  if (!word.empty() && word.find_first_not_of(kPlain) == word.npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::vector<std::string> render_options(const RenderJob& job) {
  const FrameRequest& request = job.request;
  std::vector<std::string> words = {
      "--size",      std::to_string(request.width) + "x" + std::to_string(request.height),
      "--technique", std::string(technique_table()[job.technique].id),
      "--shading",   std::string(shading_id(request.shading))};
  if (request.samples != FrameRequest().samples)
    words.insert(words.end(), {"--samples", std::to_string(request.samples)});
  if (request.occlusion_rays != FrameRequest().occlusion_rays)
    words.insert(words.end(), {"--ao", std::to_string(request.occlusion_rays)});
  words.insert(words.end(), {"--camera", camera_text(request.camera)});
  return words;
}

std::string render_command(const RenderJob& job, const std::string& path, const std::string& clip,
                           double time) {
  const fs::path file(path);
  const std::string baked = fs::path(file).replace_extension(".mdk").string();
  std::string line =
      "mdprep render " + shell_word(baked) + " -o " + shell_word(file.stem().string() + ".png");
  if (!clip.empty()) line += " --clip " + shell_word(clip);
  line += " --time " + exact_text(time);
  for (const std::string& word : render_options(job)) line.append(" ").append(shell_word(word));
  return line;
}

KeyRange keys_within(const ModelView& model, std::uint32_t clip, double begin, double end) {
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
  if (busy()) return;
  task_.start([this, order = std::move(order)] {
    ExportResult result;
    try {
      result.error = error_of(order.stem, [&] { result.sentence = render(order); });
    } catch (const MdprepTask::Cancelled&) {
      result.sentence = "Export cancelled; nothing is left of it";
    }
    result_ = std::move(result);
  });
}

std::optional<ExportResult> SequenceExport::take_result() {
  if (busy()) return {};
  return std::exchange(result_, std::nullopt);
}

// Renders the file the model was opened from, or a copy of it: what was baked from a source has no
// name any longer.
std::string SequenceExport::render(const ExportOrder& order) {
  const MdkFile& file = *order.picture.file;
  std::string path = file.path();
  std::optional<TemporaryFolder> scratch;
  if (is_no_file(path)) {
    path = scratch.emplace().file("model.mdk");
    AtomicFile copy(path);
    copy.write(file.bytes());
    copy.commit();
  }
  const KeyRange keys = order.keys;
  std::vector<std::string> arguments = {
      path, "--frames", std::to_string(keys.first) + ":" + std::to_string(keys.last)};
  const std::vector<std::string> how = render_options(order.picture);
  arguments.insert(arguments.end(), how.begin(), how.end());
  if (order.kind == ExportKind::kFilm) {
    const std::string name = numbered_name(order.stem, ".mp4", is_no_file);
    arguments.insert(arguments.end(), {"-o", name});
    task_.run_mdprep("render", arguments);
    return "Exported " + name;
  }
  PictureFolder folder(order.stem);
  arguments.insert(arguments.end(), {"-o", folder.path() + "/" + order.stem + "_####.png"});
  task_.run_mdprep("render", arguments);
  folder.keep();
  return "Exported " + std::to_string(keys.last - keys.first + 1) + " pictures to " +
         folder.path() + "/";
}

bool can_export_films() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((fs::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return true;
  return false;
}

}  // namespace mdk
