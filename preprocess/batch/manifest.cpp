// Each object knows its place, so that every complaint can name it; a field that no one asked for
// is a spelling mistake and refused.
#include "preprocess/batch/manifest.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/base/error.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

constexpr CountRange kThreadRange{1, 1024};
constexpr CountRange kMinuteRange{1, 1'000'000};
constexpr std::uint64_t kBakeMemory = std::uint64_t{2} << 30;
constexpr std::uint64_t kRenderMemory = std::uint64_t{1} << 30;

/// Options that the batch itself gives, and how to ask for them.
constexpr std::pair<std::string_view, std::string_view> kOwnOptions[] = {
    {"threads", "write \"threads\" beside \"options\""},
    {"memory-limit", "write \"memory\" beside \"options\""},
    {"frames", "write \"frames\" beside \"options\""},
    {"source", "write \"source\": true beside \"options\""},
    {"output", "write \"output\" beside \"options\""},
    {"report", "the job's record has it"},
    {"stats", "run mdprep render by hand for it"},
    {"depfile", "the engine's file asks for it"},
    {"progress", "the engine decides on it"},
    {"quiet", "the engine decides on it"},
    {"verbose", "the engine decides on it"},
    {"help", "leave it out"},
};

/// "/options/a~1b": names as JSON pointers have them.
std::string below(const std::string& place, const std::string& name) {
  std::string escaped;
  for (const char c : name) {
    if (c == '~' || c == '/') {
      escaped += c == '~' ? "~0" : "~1";
    } else {
      escaped += c;
    }
  }
  return place + "/" + escaped;
}

/// What "defaults" may say for all items of a kind.
std::vector<std::string_view> default_fields(JobKind kind) {
  std::vector<std::string_view> fields = {"options", "threads", "memory", "minutes"};
  if (kind == JobKind::kVerify) fields.insert(fields.begin(), "source");
  if (kind == JobKind::kRender) fields.insert(fields.begin(), "frames_per_job");
  return fields;
}

std::vector<std::string_view> item_fields(JobKind kind) {
  std::vector<std::string_view> fields = {"input", "exclude"};
  if (kind != JobKind::kVerify) fields.push_back("output");
  if (kind == JobKind::kRender) fields.push_back("frames");
  const std::vector<std::string_view> more = default_fields(kind);
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

class Reader {
 public:
  explicit Reader(Manifest& manifest) : manifest_(manifest) {}

  void read(const Json& root) {
    require_object(root, "", {"defaults", "bakes", "verifies", "renders", "records"});
    if (root.contains("records")) manifest_.records = path_text(root["records"], "/records");
    const Json none = Json::object();
    const Json& defaults = root.contains("defaults") ? root["defaults"] : none;
    require_object(defaults, "/defaults", {"bake", "verify", "render"});
    read_list(root, "bakes", JobKind::kBake, defaults);
    read_list(root, "verifies", JobKind::kVerify, defaults);
    read_list(root, "renders", JobKind::kRender, defaults);
    if (manifest_.items.empty())
      refuse("", "has nothing to do; list something in \"bakes\", \"verifies\" or \"renders\"");
  }

 private:
  [[noreturn]] void refuse(const std::string& place, const std::string& sentence) const {
    refuse_place(manifest_, place, sentence);
  }

  void require_object(const Json& value, const std::string& place,
                      const std::vector<std::string_view>& fields) const {
    if (!value.is_object()) refuse(place, "must be an object, { … }");
    for (const auto& [name, ignored] : value.items()) {
      if (std::find(fields.begin(), fields.end(), name) != fields.end()) continue;
      std::string known;
      for (const std::string_view field : fields)
        known.append(known.empty() ? "" : ", ").append(field);
      refuse(below(place, name), "no field has this name here; there are " + known);
    }
  }

  std::string text(const Json& value, const std::string& place) const {
    if (!value.is_string() || value.get_ref<const std::string&>().empty())
      refuse(place, "must be a text of at least one character");
    return value;
  }

  std::string path_text(const Json& value, const std::string& place) const {
    std::string path = text(value, place);
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    if (std::any_of(path.begin(), path.end(), is_control))
      refuse(place,
             "the name of a file has a control character, which no engine can hold; rename "
             "the file");
    return path;
  }

  std::vector<std::string> path_list(const Json& value, const std::string& place) const {
    if (!value.is_array()) return {path_text(value, place)};
    std::vector<std::string> paths;
    for (std::size_t i = 0; i < value.size(); ++i)
      paths.push_back(path_text(value[i], place + "/" + std::to_string(i)));
    return paths;
  }

  std::uint32_t count(const Json& value, const std::string& place, CountRange range) const {
    if (!value.is_number_integer() || value < range.lowest || value > range.highest)
      refuse(place, "must be a whole number from " + std::to_string(range.lowest) + " to " +
                        std::to_string(range.highest));
    return value;
  }

  std::uint64_t size(const Json& value, const std::string& place) const {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    try {
      return parse_size(text);
    } catch (const Error& error) {
      refuse(place, "memory " + text + ": " + error.what());
    }
  }

  std::string option_value(const Json& value, const std::string& place) const {
    if (value.is_string()) return value;
    if (value.is_number()) return value.dump();
    if (!value.is_array() || value.empty())
      refuse(place, "must be a text, a number, true, false or a list of texts and numbers");
    std::string joined;
    for (const Json& part : value) {
      if (!part.is_string() && !part.is_number())
        refuse(place, "must be a list of texts and numbers");
      joined.append(joined.empty() ? "" : ",").append(option_value(part, place));
    }
    return joined;
  }

  std::vector<std::string> option_words(const Json& options, const std::string& place) const {
    if (!options.is_object()) refuse(place, "must be an object, { … }");
    std::vector<std::string> words;
    for (const auto& [name, value] : options.items()) {
      const std::string at = below(place, name);
      for (const auto& [own, cure] : kOwnOptions)
        if (name == own) refuse(at, "is not for the manifest; " + std::string(cure));
      if (value.is_null() || value == false) continue;
      std::string& word = words.emplace_back("--").append(name);
      if (value != true) word.append("=").append(option_value(value, at));
    }
    return words;
  }

  void read_limits(const Json& fields, const std::string& place, ManifestItem& item) const {
    if (fields.contains("threads"))
      item.threads = count(fields["threads"], place + "/threads", kThreadRange);
    if (fields.contains("memory")) item.memory_bytes = size(fields["memory"], place + "/memory");
    if (fields.contains("minutes"))
      item.minutes = count(fields["minutes"], place + "/minutes", kMinuteRange);
    if (fields.contains("frames_per_job"))
      item.frames_per_job = count(fields["frames_per_job"], place + "/frames_per_job", {});
    if (fields.contains("source")) {
      if (!fields["source"].is_boolean()) refuse(place + "/source", "must be true or false");
      item.with_source = fields["source"];
    }
  }

  void read_item(const Json& fields, JobKind kind, const Json& defaults, ManifestItem item) {
    const std::string& place = item.place;
    const std::string default_place = std::string("/defaults/") + kind_name(kind);
    require_object(defaults, default_place, default_fields(kind));
    require_object(fields, place, item_fields(kind));
    item.memory_bytes = kind == JobKind::kRender ? kRenderMemory : kBakeMemory;
    read_limits(defaults, default_place, item);
    read_limits(fields, place, item);

    if (!fields.contains("input")) refuse(place, "has no \"input\"; name a file or a pattern");
    item.inputs = path_list(fields["input"], place + "/input");
    if (item.inputs.empty()) refuse(place + "/input", "names no file");
    if (fields.contains("exclude")) item.exclude = path_list(fields["exclude"], place + "/exclude");
    if (kind != JobKind::kVerify) {
      if (!fields.contains("output"))
        refuse(place, "has no \"output\"; name a file, as in \"out/{stem}" +
                          std::string(kind == JobKind::kBake ? ".mdk\"" : "_####.png\""));
      item.output = path_text(fields["output"], place + "/output");
    }
    if (fields.contains("frames")) {
      const Json& frames = fields["frames"];
      item.frames = frames.is_number() ? frames.dump() : text(frames, place + "/frames");
    }
    Json options = defaults.contains("options") ? defaults["options"] : Json::object();
    if (fields.contains("options")) {
      option_words(fields["options"], place + "/options");  // complain about the item, not the sum
      options.update(fields["options"]);
    }
    item.options = option_words(options, default_place + "/options");
    manifest_.items.push_back(std::move(item));
  }

  void read_list(const Json& root, const char* name, JobKind kind, const Json& defaults) {
    if (!root.contains(name)) return;
    const Json& list = root[name];
    const std::string place = std::string("/") + name;
    if (!list.is_array()) refuse(place, "must be a list, [ … ]");
    const Json of_kind =
        defaults.contains(kind_name(kind)) ? defaults[kind_name(kind)] : Json::object();
    for (std::size_t i = 0; i < list.size(); ++i) {
      ManifestItem item;
      item.kind = kind;
      item.place = place + "/" + std::to_string(i);
      read_item(list[i], kind, of_kind, std::move(item));
    }
  }

  Manifest& manifest_;
};

std::string read_whole(const std::string& path) {
  std::error_code problem;
  if (std::filesystem::is_directory(path, problem))
    throw io_error(path, "is a folder; name the manifest in it");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw io_error(path, "cannot be read; check its name and permissions");
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

const char* kind_name(JobKind kind) {
  switch (kind) {
    case JobKind::kBake:
      return "bake";
    case JobKind::kVerify:
      return "verify";
    case JobKind::kRender:
      break;
  }
  return "render";
}

void refuse_place(const Manifest& manifest, const std::string& place, const std::string& sentence) {
  throw bad_input(manifest.path, (place.empty() ? "the manifest" : place) + ": " + sentence);
}

Manifest read_manifest(const std::string& path) {
  Manifest manifest;
  manifest.path = path;
  const std::string folder = std::filesystem::path(path).parent_path().string();
  manifest.folder = folder.empty() ? "." : folder;
  manifest.records = "records";
  const std::string text = read_whole(path);
  Json root;
  try {
    root = Json::parse(text);
  } catch (const Json::parse_error& problem) {
    const std::size_t at = std::min<std::size_t>(problem.byte, text.size());
    const auto line =
        1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    throw bad_input(path, "is no JSON from line " + std::to_string(line) +
                              " on; look for a missing comma or quote there");
  } catch (const Json::exception&) {
    throw bad_input(path, "holds a number that is out of range");
  }
  Reader(manifest).read(root);
  return manifest;
}

}  // namespace mdk
