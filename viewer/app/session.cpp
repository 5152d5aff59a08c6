#include "viewer/app/session.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>

#include "common/base/error.h"
#include "common/trace/technique.h"
#include "formats/files/atomic_file.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxBytes = 1 << 20;

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

Json session_json(const SavedSession& session) {
  Json json = {{"schema", "mdview-session/1"}};
  if (session.window) json["window"] = {session.window->width, session.window->height};
  const ViewSettings& settings = session.settings;
  json["technique"] = technique_table()[settings.technique].id;
  json["shading"] = shading_id(settings.shading);
  json["light"] = settings.colors == ColorScheme::kLight;
  json["text_percent"] = settings.text_percent;
  json["count_work"] = settings.count_work;
  json["resolution"] = static_cast<int>(settings.resolution);
  json["loop"] = static_cast<int>(session.loop);
  json["speed"] = session.speed;
  json["panel"] = session.panel == PanelMode::kShown;
  json["recent"] = Json::array();
  for (const FileChoice& choice : session.recent) json["recent"].push_back(choice.paths);
  return json;
}

/// The value under `name` if it is there and of this kind.
template <class Value>
std::optional<Value> value_of(const Json& json, const char* name) {
  try {
    return json.at(name).get<Value>();
  } catch (const Json::exception&) {
    return {};
  }
}

/// An enumeration that counts from 0 to `last`.
template <class Enum>
void read_choice(const Json& json, const char* name, Enum last, Enum& into) {
  const auto number = value_of<double>(json, name);
  if (number && *number >= 0 && *number <= static_cast<int>(last))
    into = static_cast<Enum>(static_cast<int>(*number));
}

std::optional<WindowSize> read_window(const Json& json) {
  const auto sides = value_of<std::vector<double>>(json, "window");
  if (!sides || sides->size() != 2) return {};
  for (const double side : *sides)
    if (!(side >= kMinWindowSide && side <= kMaxImageSide)) return {};
  return WindowSize{static_cast<std::uint32_t>((*sides)[0]),
                    static_cast<std::uint32_t>((*sides)[1])};
}

std::vector<FileChoice> read_recent(const Json& json) {
  std::vector<FileChoice> recent;
  const auto at = json.find("recent");
  if (at == json.end() || !at->is_array()) return recent;
  for (auto entry = at->rbegin(); entry != at->rend(); ++entry) {
    std::vector<std::string> paths;
    if (!entry->is_array()) continue;
    for (const Json& path : *entry)
      if (path.is_string()) paths.push_back(path.get<std::string>());
    remember_file(recent, paths);
  }
  return recent;
}

SavedSession session_of(const Json& json) {
  SavedSession session;
  session.window = read_window(json);
  ViewSettings& settings = session.settings;
  const auto technique = value_of<std::string>(json, "technique");
  for (std::size_t row = 0; technique && row < technique_table().size(); ++row)
    if (technique_table()[row].id == *technique) settings.technique = row;
  const auto shading = value_of<std::string>(json, "shading");
  for (const ShadingInfo& info : shading_table())
    if (shading && info.id == *shading) settings.shading = info.mode;
  if (value_of<bool>(json, "light").value_or(false)) settings.colors = ColorScheme::kLight;
  if (const auto percent = value_of<double>(json, "text_percent"))
    settings.text_percent =
        static_cast<int>(std::clamp(*percent, double{kMinTextPercent}, double{kMaxTextPercent}));
  settings.count_work = value_of<bool>(json, "count_work").value_or(false);
  read_choice(json, "resolution", Resolution::kAuto, settings.resolution);
  read_choice(json, "loop", LoopMode::kPingPong, session.loop);
  if (const auto speed = value_of<double>(json, "speed"))
    session.speed = std::clamp(*speed, kMinSpeed, kMaxSpeed);
  if (!value_of<bool>(json, "panel").value_or(true)) session.panel = PanelMode::kHidden;
  session.recent = read_recent(json);
  return session;
}

}  // namespace

void recall(const SavedSession& session, ViewState& state) {
  state.settings = session.settings;
  state.panel = session.panel;
  state.recent_files = session.recent;
  state.playback.set_loop(session.loop);
  state.playback.set_speed(session.speed);
}

SavedSession session_to_keep(const ViewState& state, const WindowSize& window) {
  return {window,      state.settings,    state.playback.loop(), state.playback.speed(),
          state.panel, state.recent_files};
}

std::string session_path(const ViewerOptions& options) {
  if (!options.state_file.empty()) return options.state_file;
  if (options.no_state || options.print_state || options.quit_after > 0) return {};
  fs::path folder = variable("XDG_STATE_HOME");
  if (!folder.is_absolute()) {
    const std::string home = variable("HOME");
    if (home.empty()) return {};
    folder = fs::path(home) / ".local" / "state";
  }
  return (folder / "mdview" / "session.json").string();
}

SavedSession read_session(const std::string& path) {
  std::error_code failure;
  if (path.empty() || !fs::is_regular_file(path, failure)) return {};
  if (fs::file_size(path, failure) > kMaxBytes || failure) return {};
  std::ifstream in(path);
  const Json json = Json::parse(in, nullptr, false);
  return json.is_object() ? session_of(json) : SavedSession{};
}

bool write_session(const SavedSession& session, const std::string& path) {
  try {
    const fs::path folder = fs::path(path).parent_path();
    if (!folder.empty()) fs::create_directories(folder);
    const std::string text =
        session_json(session).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
    AtomicFile file(path);
    file.write(std::as_bytes(std::span(text)));
    file.commit();
    return true;
  } catch (const Error&) {
    return false;
  } catch (const fs::filesystem_error&) {
    return false;
  }
}

}  // namespace mdk
