#include "preprocess/cli/bench/result_json.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/base/error.h"
#include "preprocess/cli/text_file.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kBenchSchema = "mdprep-bench/1";
constexpr const char* kBakeSchema = "mdprep-bake/1";
constexpr std::size_t kLargestFile = std::size_t{256} << 20;

double frames_per_second(double time_to_image_ms) {
  return time_to_image_ms > 0 ? 1000 / time_to_image_ms : 0;
}

// --- writing ---

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

/// To 10 ns, as frames are measured.
double rounded(double milliseconds) { return std::round(milliseconds * 1e5) / 1e5; }

Json frame_json(const BenchFrame& frame) {
  return {{"key", frame.key},
          {"time_to_image_ms", rounded(frame.time_to_image_ms())},
          {"pose_ms", frame.pose_ms},
          {"update_ms", frame.update_ms},
          {"trace_ms", frame.trace_ms},
          {"shade_ms", frame.shade_ms},
          {"node_visits", frame.counters.node_visits},
          {"triangle_tests", frame.counters.triangle_tests},
          {"triangle_setups", frame.counters.triangle_setups},
          {"clusters_entered", frame.counters.clusters_entered},
          {"structure_bytes", frame.structure_bytes}};
}

Json technique_json(const TechniqueBench& technique) {
  const Quartiles image = technique.time_to_image_ms();
  const WorkPerRay work = technique.work();
  Json frames = Json::array();
  for (const BenchFrame& frame : technique.frames) frames.push_back(frame_json(frame));
  Json row = {{"id", technique.id},
              {"pose_ms", technique.median_pose_ms()},
              {"update_ms", technique.median_update_ms()},
              {"trace_ms", technique.median_trace_ms()},
              {"shade_ms", technique.median_shade_ms()},
              {"time_to_image_ms", image.median},
              {"time_to_image_quartiles_ms", {image.low, image.high}},
              {"round_medians_ms", technique.round_medians_ms},
              {"fps", frames_per_second(image.median)},
              {"node_visits_per_ray", work.node_visits},
              {"triangle_tests_per_ray", work.triangle_tests},
              {"clusters_per_ray", work.clusters},
              {"structure_bytes", technique.structure_bytes},
              {"prebuild_ms", technique.prebuild_ms},
              {"hit_mismatches", technique.hit_mismatches},
              {"judged_frames", technique.judged_frames}};
  if (!technique.note.empty()) row["note"] = technique.note;
  row["rays_per_frame"] = technique.rays_per_frame;
  row["frames"] = std::move(frames);
  return row;
}

/// With the names of the bake's own report.
Json bake_json(const BakeFacts& bake) {
  Json growth = Json::array();
  for (const GrowthRow& row : bake.growth)
    growth.push_back({{"clusters", row.clusters},
                      {"residual_rms", row.residual_rms},
                      {"fuzzy_area", row.fuzzy_area},
                      {"sah_cost", row.sah_cost}});
  return {{"segments", bake.segments},
          {"stop_reason", bake.stop_reason},
          {"residual_rms", bake.residual_rms},
          {"residual_max", bake.residual_max},
          {"sah_cost", bake.sah_cost},
          {"seconds",
           {{"read", bake.read_s},
            {"decompose", bake.decompose_s},
            {"build", bake.build_s},
            {"write", bake.write_s},
            {"total", bake.total_s}}},
          {"peak_memory_bytes", bake.peak_memory_bytes},
          {"file_bytes", bake.file_bytes},
          {"growth", growth}};
}

Json model_json(const ModelBench& model) {
  Json row = {{"file", model.file},
              {"triangles", model.triangles},
              {"keys", model.keys},
              {"clusters", model.clusters}};
  if (model.bake) row["bake"] = bake_json(*model.bake);
  row["techniques"] = Json::array();
  for (const TechniqueBench& technique : model.techniques)
    row["techniques"].push_back(technique_json(technique));
  return row;
}

Json run_json(const BenchRun& run) {
  Json row = {{"isa", run.isa},       {"threads", run.threads}, {"width", run.width},
              {"height", run.height}, {"shading", run.shading}, {"models", Json::array()}};
  for (const ModelBench& model : run.models) row["models"].push_back(model_json(model));
  return row;
}

// --- reading ---

/// A value at a known place, so that what is wrong with it can be told.
class Reader {
 public:
  Reader(const Json& value, std::string place) : value_(&value), place_(std::move(place)) {}

  Reader operator[](const char* name) const {
    if (!value_->is_object() || !value_->contains(name)) refuse(std::string("has no ") + name);
    return {(*value_)[name], place_ + ": " + name};
  }
  bool has(const char* name) const { return value_->is_object() && value_->contains(name); }

  double number() const {
    if (!value_->is_number()) refuse("is not a number");
    const double value = value_->get<double>();
    if (!std::isfinite(value) || value < 0) refuse("is not a number that can be measured");
    return value;
  }
  std::uint64_t count() const {
    if (!value_->is_number_unsigned()) refuse("is not a whole number");
    return value_->get<std::uint64_t>();
  }
  std::uint32_t small_count() const {
    const std::uint64_t value = count();
    if (value > 0xffffffffu) refuse("is too large");
    return static_cast<std::uint32_t>(value);
  }
  std::string text() const {
    if (!value_->is_string()) refuse("is not text");
    return value_->get<std::string>();
  }
  std::vector<Reader> items() const {
    if (!value_->is_array()) refuse("is not a list");
    std::vector<Reader> readers;
    readers.reserve(value_->size());
    for (std::size_t i = 0; i < value_->size(); ++i)
      readers.emplace_back((*value_)[i], place_ + " " + std::to_string(i));
    return readers;
  }
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::kBadInput,
                place_ + " " + what + "; the file is damaged or of another version");
  }

 private:
  const Json* value_;
  std::string place_;
};

/// Text that may be missing.
std::string optional_text(const Reader& object, const char* name) {
  return object.has(name) ? object[name].text() : std::string();
}
std::uint64_t optional_count(const Reader& object, const char* name) {
  return object.has(name) ? object[name].count() : 0;
}
double optional_number(const Reader& object, const char* name) {
  return object.has(name) ? object[name].number() : 0;
}

BenchFrame read_frame(const Reader& row) {
  BenchFrame frame;
  frame.key = row["key"].small_count();
  frame.pose_ms = row["pose_ms"].number();
  frame.update_ms = row["update_ms"].number();
  frame.trace_ms = row["trace_ms"].number();
  frame.shade_ms = row["shade_ms"].number();
  frame.counters.node_visits = row["node_visits"].count();
  frame.counters.triangle_tests = row["triangle_tests"].count();
  frame.counters.triangle_setups = optional_count(row, "triangle_setups");
  frame.counters.clusters_entered = row["clusters_entered"].count();
  frame.structure_bytes = row["structure_bytes"].count();
  return frame;
}

TechniqueBench read_technique(const Reader& row) {
  TechniqueBench technique;
  technique.id = row["id"].text();
  for (const Reader& round : row["round_medians_ms"].items())
    technique.round_medians_ms.push_back(round.number());
  technique.rays_per_frame = row["rays_per_frame"].count();
  technique.structure_bytes = row["structure_bytes"].count();
  technique.prebuild_ms = row["prebuild_ms"].number();
  technique.hit_mismatches = row["hit_mismatches"].count();
  technique.judged_frames = row["judged_frames"].count();
  technique.note = optional_text(row, "note");
  for (const Reader& frame : row["frames"].items()) technique.frames.push_back(read_frame(frame));
  if (technique.frames.empty()) row.refuse("has no frames");
  return technique;
}

BakeFacts read_bake(const Reader& row) {
  BakeFacts bake;
  bake.segments = row["segments"].small_count();
  bake.stop_reason = row["stop_reason"].text();
  bake.residual_rms = row["residual_rms"].number();
  bake.residual_max = row["residual_max"].number();
  bake.sah_cost = row["sah_cost"].number();
  const Reader seconds = row["seconds"];
  bake.read_s = seconds["read"].number();
  bake.decompose_s = seconds["decompose"].number();
  bake.build_s = seconds["build"].number();
  bake.write_s = seconds["write"].number();
  bake.total_s = seconds["total"].number();
  bake.peak_memory_bytes = row["peak_memory_bytes"].count();
  bake.file_bytes = row["file_bytes"].count();
  if (!row.has("growth")) return bake;
  for (const Reader& step : row["growth"].items())
    bake.growth.push_back({step["clusters"].small_count(), step["residual_rms"].number(),
                           optional_number(step, "fuzzy_area"), step["sah_cost"].number()});
  return bake;
}

ModelBench read_model(const Reader& row) {
  ModelBench model;
  model.file = row["file"].text();
  model.triangles = row["triangles"].small_count();
  model.keys = row["keys"].small_count();
  model.clusters = row["clusters"].small_count();
  if (row.has("bake")) model.bake = read_bake(row["bake"]);
  for (const Reader& technique : row["techniques"].items())
    model.techniques.push_back(read_technique(technique));
  if (model.techniques.empty()) row.refuse("has no techniques");
  return model;
}

BenchRun read_run(const Reader& row) {
  BenchRun run;
  run.isa = row["isa"].text();
  run.threads = static_cast<int>(row["threads"].small_count());
  run.width = row["width"].small_count();
  run.height = row["height"].small_count();
  run.shading = optional_text(row, "shading");
  for (const Reader& model : row["models"].items()) run.models.push_back(read_model(model));
  if (run.models.empty()) row.refuse("has no models");
  return run;
}

Json parse_json(std::string_view text, const std::string& origin) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw bad_input(origin, "is not JSON");
  return json;
}

}  // namespace

std::string results_json(const BenchResults& results) {
  Json report = {{"schema", kBenchSchema}};
  report.update(run_json(results.runs.front()));
  Json models = std::move(report["models"]);
  report.erase("models");
  report["cpu"] = results.machine.cpu;
  report["cores"] = results.machine.cores;
  report["program"] = {{"version", results.program.version},
                       {"commit", results.program.commit},
                       {"compiler", results.program.compiler}};
  report["command"] = results.command;
  report["models"] = std::move(models);
  if (results.runs.size() > 1) {
    report["further_runs"] = Json::array();
    for (std::size_t i = 1; i < results.runs.size(); ++i)
      report["further_runs"].push_back(run_json(results.runs[i]));
  }
  std::string text;
  append_json(report, 0, text);
  return text + "\n";
}

BenchResults parse_results(std::string_view text, const std::string& origin) {
  const Json json = parse_json(text, origin);
  const Reader report(json, origin);
  if (report["schema"].text() != kBenchSchema)
    report.refuse("is not of the schema " + std::string(kBenchSchema));
  BenchResults results;
  results.machine.cpu = optional_text(report, "cpu");
  results.machine.cores = static_cast<int>(report.has("cores") ? report["cores"].small_count() : 0);
  if (report.has("program")) {
    const Reader program = report["program"];
    results.program = {optional_text(program, "version"), optional_text(program, "commit"),
                       optional_text(program, "compiler")};
  }
  results.command = optional_text(report, "command");
  results.runs.push_back(read_run(report));
  if (report.has("further_runs"))
    for (const Reader& run : report["further_runs"].items()) results.runs.push_back(read_run(run));
  return results;
}

BenchResults read_results(const std::string& path) {
  return parse_results(read_text_file(path, kLargestFile), path);
}

std::optional<BakeFacts> read_bake_facts(const std::string& mdk_path, std::uint32_t triangles,
                                         std::uint32_t keys, std::uint32_t clusters) {
  for (const char* ending : {".bake.json", ".json"}) {
    const std::string path = std::filesystem::path(mdk_path).replace_extension(ending).string();
    std::error_code problem;
    if (!std::filesystem::is_regular_file(path, problem)) continue;
    const Json json = Json::parse(read_text_file(path, kLargestFile), nullptr, false);
    if (json.is_discarded() || !json.is_object() || json.value("schema", Json()) != kBakeSchema)
      continue;
    const Reader report(json, path);
    if (report["triangles"].count() == triangles && report["keys"].count() == keys &&
        report["clusters"].count() == clusters)
      return read_bake(report);
  }
  return std::nullopt;
}

}  // namespace mdk
