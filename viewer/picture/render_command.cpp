#include "viewer/picture/render_command.h"

#include <charconv>
#include <filesystem>
#include <string_view>

#include "common/trace/technique.h"

namespace mdk {
namespace {

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

std::string shading_id(ShadingMode mode) {
  for (const ShadingInfo& info : shading_table())
    if (info.mode == mode) return std::string(info.id);
  return {};
}

}  // namespace

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
      "--shading",   shading_id(request.shading)};
  if (request.samples != FrameRequest().samples)
    words.insert(words.end(), {"--samples", std::to_string(request.samples)});
  if (request.occlusion_rays != FrameRequest().occlusion_rays)
    words.insert(words.end(), {"--ao", std::to_string(request.occlusion_rays)});
  words.insert(words.end(), {"--camera", camera_text(request.camera)});
  return words;
}

std::string render_command(const RenderJob& job, const std::string& path, const std::string& clip,
                           double time) {
  const std::filesystem::path file(path);
  const std::string baked = std::filesystem::path(file).replace_extension(".mdk").string();
  std::string line =
      "mdprep render " + shell_word(baked) + " -o " + shell_word(file.stem().string() + ".png");
  if (!clip.empty()) line += " --clip " + shell_word(clip);
  line += " --time " + exact_text(time);
  for (const std::string& word : render_options(job)) line.append(" ").append(shell_word(word));
  return line;
}

}  // namespace mdk
