// Bench results as a file. What a file holds is said once, in describe(), for writing and reading.
//
//     field      is always there; a list has at least one item
//     newer      is always written; files of older versions lack it
//     optional   is left out where there is nothing
//     derived    follows from other fields: for scripts, written and never read
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "preprocess/bench/results.h"
#include "preprocess/tool/files.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kBenchSchema = "mdprep-bench/1";
constexpr const char* kBakeSchema = "mdprep-bake/1";
constexpr std::size_t kMaxFileBytes = std::size_t{256} << 20;

template <class Value>
constexpr bool kIsList = false;
template <class Item>
constexpr bool kIsList<std::vector<Item>> = true;

/// Writes the fields of a struct into an object, or reads them from one at a known place, so that
/// a message can say what is wrong there.
class Fields {
 public:
  Fields() = default;
  Fields(const Json& from, std::string place) : from_(&from), place_(std::move(place)) {}

  template <class Value>
  void field(const char* name, Value& value) {
    newer(name, value);
    if (!is_reading()) return;
    bool is_there = has(name);
    if constexpr (kIsList<Value>) is_there = !value.empty();
    require(is_there, std::string("has no ") + name);
  }
  template <class Value>
  void newer(const char* name, Value& value) {
    if (!is_reading()) {
      written_[name] = json_of(value);
    } else if (has(name)) {
      Fields((*from_)[name], place_ + ": " + name).read(value);
    }
  }
  template <class Value>
  void optional(const char* name, Value& value) {  // text or a list
    if (is_reading() || !value.empty()) newer(name, value);
  }
  void optional(const char* name, double& value) {
    if (is_reading() || value != 0) newer(name, value);
  }
  template <class Value>
  void optional(const char* name, std::optional<Value>& value) {
    if (is_reading() && has(name)) value.emplace();
    if (value) newer(name, *value);
  }
  void derived(const char* name, const Json& value) {
    if (!is_reading()) written_[name] = value;
  }

  template <class Value>
  static Json json_of(Value& value) {
    if constexpr (std::is_arithmetic_v<Value> || std::is_same_v<Value, std::string>) {
      return value;
    } else if constexpr (kIsList<Value>) {
      Json list = Json::array();
      for (auto& item : value) list.push_back(json_of(item));
      return list;
    } else {
      Fields part;
      describe(part, value);
      return std::move(part.written_);
    }
  }

  template <class Value>
  void read(Value& value) {
    if constexpr (std::is_same_v<Value, double>) {
      require(from_->is_number(), "is not a number");
      value = from_->get<double>();
      require(std::isfinite(value) && value >= 0, "is not a number that can be measured");
    } else if constexpr (std::is_same_v<Value, bool>) {
      require(from_->is_boolean(), "is neither true nor false");
      value = from_->get<bool>();
    } else if constexpr (std::is_integral_v<Value>) {
      require(from_->is_number_unsigned(), "is not a whole number");
      const auto count = from_->get<std::uint64_t>();
      require(sizeof(Value) == 8 || count <= 0xffffffffu, "is too large");
      value = static_cast<Value>(count);
    } else if constexpr (std::is_same_v<Value, std::string>) {
      require(from_->is_string(), "is not text");
      value = from_->get<std::string>();
    } else if constexpr (kIsList<Value>) {
      require(from_->is_array(), "is not a list");
      for (std::size_t i = 0; i < from_->size(); ++i)
        Fields((*from_)[i], place_ + " " + std::to_string(i)).read(value.emplace_back());
    } else {
      describe(*this, value);
    }
  }
  void require(bool is_right, const std::string& otherwise) const {
    if (!is_right)
      throw Error(ErrorCode::kBadInput,
                  place_ + " " + otherwise + "; the file is damaged or of another version");
  }

 private:
  bool is_reading() const { return from_ != nullptr; }
  bool has(const char* name) const { return from_->is_object() && from_->contains(name); }

  const Json* from_ = nullptr;
  std::string place_;
  Json written_ = Json::object();
};

/// To 10 ns, as frames are measured.
double rounded(double milliseconds) { return std::round(milliseconds * 1e5) / 1e5; }

void describe(Fields& io, BenchFrame& frame) {
  io.field("key", frame.key);
  io.derived("time_to_image_ms", rounded(frame.time_to_image_ms()));
  io.field("pose_ms", frame.pose_ms);
  io.field("update_ms", frame.update_ms);
  io.field("trace_ms", frame.trace_ms);
  io.field("shade_ms", frame.shade_ms);
  io.field("node_visits", frame.counters.node_visits);
  io.field("triangle_tests", frame.counters.triangle_tests);
  io.newer("triangle_setups", frame.counters.leaf_triangles);  // its name in files
  io.field("clusters_entered", frame.counters.clusters_entered);
  io.newer("hits", frame.hits);
  io.field("structure_bytes", frame.structure_bytes);
}

void describe(Fields& io, TechniqueBench& technique) {
  const Quartiles image = technique.time_to_image_ms();
  const WorkPerRay work = technique.work();
  io.field("id", technique.id);
  io.derived("pose_ms", technique.median_ms(&BenchFrame::pose_ms));
  io.derived("update_ms", technique.median_ms(&BenchFrame::update_ms));
  io.derived("trace_ms", technique.median_ms(&BenchFrame::trace_ms));
  io.derived("shade_ms", technique.median_ms(&BenchFrame::shade_ms));
  io.derived("time_to_image_ms", image.median);
  io.derived("time_to_image_quartiles_ms", {image.low, image.high});
  io.newer("round_medians_ms", technique.round_medians_ms);
  io.derived("fps", technique.fps());
  io.derived("node_visits_per_ray", work.node_visits);
  if (technique.has_leaf_counts()) io.derived("leaf_triangles_per_ray", work.leaf_triangles);
  io.derived("triangle_tests_per_ray", work.triangle_tests);
  io.derived("clusters_per_ray", work.clusters);
  io.optional("kd_cost_ratio", technique.kd_cost_ratio);
  io.field("structure_bytes", technique.structure_bytes);
  io.field("prebuild_ms", technique.prebuild_ms);
  io.field("hit_mismatches", technique.hit_mismatches);
  io.field("judged_frames", technique.judged_frames);
  io.optional("note", technique.note);
  io.field("rays_per_frame", technique.rays_per_frame);
  io.field("frames", technique.frames);
}

void describe(Fields& io, GrowthStep& step) {
  io.field("clusters", step.clusters);
  io.field("residual_rms", step.residual_rms);
  io.newer("fuzzy_area", step.fuzzy_area);
  io.field("sah_cost", step.sah_cost);
}

void describe(Fields& io, BakeFacts::Seconds& seconds) {
  io.field("read", seconds.read);
  io.field("decompose", seconds.decompose);
  io.field("build", seconds.build);
  io.field("write", seconds.write);
  io.field("total", seconds.total);
}

/// With the names of the bake's own report.
void describe(Fields& io, BakeFacts& bake) {
  io.field("segments", bake.segments);
  io.field("stop_reason", bake.stop_reason);
  io.field("residual_rms", bake.residual_rms);
  io.field("residual_max", bake.residual_max);
  io.field("sah_cost", bake.sah_cost);
  io.field("seconds", bake.seconds);
  io.field("peak_memory_bytes", bake.peak_memory_bytes);
  io.field("file_bytes", bake.file_bytes);
  io.newer("growth", bake.growth);
}

void describe(Fields& io, ModelBench& model) {
  io.field("file", model.file);
  io.field("triangles", model.triangles);
  io.field("keys", model.keys);
  io.field("clusters", model.clusters);
  io.newer("between_keys", model.between_keys);
  io.optional("predicted_cost", model.predicted_cost);
  io.optional("bake", model.bake);
  io.field("techniques", model.techniques);
}

void describe(Fields& io, BenchSetting& setting) {
  io.field("isa", setting.isa);
  io.field("threads", setting.threads);
  io.field("width", setting.width);
  io.field("height", setting.height);
  io.newer("shading", setting.shading);
}

void describe(Fields& io, BenchRun& run) {
  describe(io, run.setting);
  io.field("models", run.models);
}

void describe(Fields& io, BenchProgram& program) {
  io.newer("version", program.version);
  io.newer("commit", program.commit);
  io.newer("compiler", program.compiler);
}

/// There is a first run, be it empty.
void describe(Fields& io, BenchResults& results) {
  io.derived("schema", kBenchSchema);
  describe(io, results.runs.front().setting);
  io.newer("cpu", results.machine.cpu);
  io.newer("cores", results.machine.cores);
  io.newer("program", results.program);
  io.newer("command", results.command);
  io.field("models", results.runs.front().models);
  std::vector<BenchRun> further(results.runs.begin() + 1, results.runs.end());
  io.optional("further_runs", further);
  results.runs.resize(1);
  std::move(further.begin(), further.end(), std::back_inserter(results.runs));
}

/// Values that hold no others' lists stay on one line: a frame is a line, as in a table.
void append_json(const Json& value, std::size_t depth, std::string& text) {
  const bool is_flat = std::none_of(value.begin(), value.end(),
                                    [](const Json& part) { return part.is_structured(); });
  if (!value.is_structured() || is_flat) {
    text += value.dump(-1, ' ', false, Json::error_handler_t::replace);
    return;
  }
  const bool has_names = value.is_object();
  char before = has_names ? '{' : '[';
  for (const auto& [name, part] : value.items()) {
    text += before;
    text.append(1, '\n').append(depth + 1, ' ');
    if (has_names) text.append(Json(name).dump()).append(": ");
    append_json(part, depth + 1, text);
    before = ',';
  }
  text.append(1, '\n').append(depth, ' ').append(1, has_names ? '}' : ']');
}

}  // namespace

std::string results_json(const BenchResults& results) {
  BenchResults written = results;  // describe() takes what it could read into
  std::string text;
  append_json(Fields::json_of(written), 0, text);
  return text + "\n";
}

BenchResults parse_results(std::string_view text, const std::string& origin) {
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw bad_input(origin, "is not JSON");
  Fields report(json, origin);
  std::string schema;
  report.field("schema", schema);
  report.require(schema == kBenchSchema, "is not of the schema " + std::string(kBenchSchema));
  BenchResults results;
  results.runs.resize(1);
  report.read(results);
  return results;
}

BenchResults read_results(const std::string& path) {
  return parse_results(read_text_file(path, kMaxFileBytes), path);
}

std::optional<BakeFacts> read_bake_facts(const std::string& mdk_path, std::uint32_t triangles,
                                         std::uint32_t keys, std::uint32_t clusters) {
  for (const char* ending : {".bake.json", ".json"}) {
    const std::string path = std::filesystem::path(mdk_path).replace_extension(ending).string();
    std::error_code problem;
    if (!std::filesystem::is_regular_file(path, problem)) continue;
    const Json json = Json::parse(read_text_file(path, kMaxFileBytes), nullptr, false);
    if (json.is_discarded() || !json.is_object() || json.value("schema", Json()) != kBakeSchema)
      continue;
    Fields report(json, path);
    std::uint64_t counts[3] = {};
    report.field("triangles", counts[0]);
    report.field("keys", counts[1]);
    report.field("clusters", counts[2]);
    if (counts[0] != triangles || counts[1] != keys || counts[2] != clusters) continue;
    BakeFacts facts;
    report.read(facts);
    return facts;
  }
  return std::nullopt;
}

}  // namespace mdk
