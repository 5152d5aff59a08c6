#include "preprocess/cli/bench_report.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <ostream>

#include "preprocess/cli/number_text.h"
#include "preprocess/cli/text_table.h"
#include "preprocess/cli/work_per_ray.h"

namespace mdk {
namespace {

using Json = nlohmann::ordered_json;

double frames_per_second(double time_to_image_ms) {
  return time_to_image_ms > 0 ? 1000 / time_to_image_ms : 0;
}

/// Everything a technique's row holds, but not the frames; the CSV has the same fields.
Json technique_row(const TechniqueBench& technique) {
  const FrameStats phases = technique.median_phases();
  const double time_to_image_ms = technique.median_time_to_image_ms();
  const WorkPerRay work = work_per_ray(technique.counters, technique.rays);
  return {{"id", technique.id},
          {"pose_ms", phases.pose_ms},
          {"update_ms", phases.update_ms},
          {"trace_ms", phases.trace_ms},
          {"shade_ms", phases.shade_ms},
          {"time_to_image_ms", time_to_image_ms},
          {"fps", frames_per_second(time_to_image_ms)},
          {"node_visits_per_ray", work.node_visits},
          {"triangle_tests_per_ray", work.triangle_tests},
          {"clusters_per_ray", work.clusters},
          {"structure_bytes", technique.structure_bytes},
          {"prebuild_ms", technique.prebuild_ms},
          {"hit_mismatches", technique.hit_mismatches}};
}

Json frame_rows(const TechniqueBench& technique) {
  Json rows = Json::array();
  for (const BenchFrame& frame : technique.frames)
    rows.push_back({{"key", frame.key},
                    {"time_to_image_ms", frame.stats.time_to_image_ms()},
                    {"update_ms", frame.stats.update_ms},
                    {"trace_ms", frame.stats.trace_ms}});
  return rows;
}

/// Quoted where it must be (RFC 4180).
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::vector<std::string> table_row(const std::string& model, const TechniqueBench& technique) {
  const FrameStats phases = technique.median_phases();
  const double time_to_image_ms = technique.median_time_to_image_ms();
  const WorkPerRay work = work_per_ray(technique.counters, technique.rays);
  return {model,
          technique.id,
          fixed_text(phases.pose_ms, 2),
          fixed_text(phases.update_ms, 2),
          fixed_text(phases.trace_ms, 2),
          fixed_text(phases.shade_ms, 2),
          fixed_text(time_to_image_ms, 2),
          fixed_text(frames_per_second(time_to_image_ms), 1),
          fixed_text(work.node_visits, 3),
          fixed_text(work.triangle_tests, 3),
          fixed_text(work.clusters, 3),
          bytes_text(technique.structure_bytes),
          fixed_text(technique.prebuild_ms, 1),
          std::to_string(technique.hit_mismatches)};
}

std::string name_of(const ModelBench& model) {
  return std::filesystem::path(model.file).stem().string();
}

}  // namespace

void print_bench_table(std::ostream& out, std::span<const ModelBench> models) {
  TextTable table(2);
  table.add_row({"model", "technique", "pose ms", "update ms", "trace ms", "shade ms", "image ms",
                 "fps", "visits/ray", "tests/ray", "clusters/ray", "memory", "prebuild ms",
                 "mismatches"});
  for (const ModelBench& model : models)
    for (const TechniqueBench& technique : model.techniques)
      table.add_row(table_row(name_of(model), technique));
  table.print(out);
  for (const ModelBench& model : models)
    for (const TechniqueBench& technique : model.techniques)
      if (!technique.note.empty())
        out << name_of(model) << " " << technique.id << ": " << technique.note << "\n";
}

std::string bench_json(const BenchMachine& machine, std::span<const ModelBench> models) {
  Json model_rows = Json::array();
  for (const ModelBench& model : models) {
    Json techniques = Json::array();
    for (const TechniqueBench& technique : model.techniques) {
      Json row = technique_row(technique);
      if (!technique.note.empty()) row["note"] = technique.note;
      row["frames"] = frame_rows(technique);
      techniques.push_back(std::move(row));
    }
    model_rows.push_back({{"file", model.file},
                          {"triangles", model.triangles},
                          {"keys", model.keys},
                          {"clusters", model.clusters},
                          {"techniques", std::move(techniques)}});
  }
  const Json report = {{"schema", "mdprep-bench/1"}, {"isa", machine.isa},
                       {"threads", machine.threads}, {"width", machine.width},
                       {"height", machine.height},   {"models", model_rows}};
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string bench_csv(const BenchMachine& machine, std::span<const ModelBench> models) {
  std::string header, lines;
  for (const ModelBench& model : models)
    for (const TechniqueBench& technique : model.techniques) {
      Json row = {{"file", model.file},         {"isa", machine.isa},
                  {"threads", machine.threads}, {"width", machine.width},
                  {"height", machine.height},   {"triangles", model.triangles},
                  {"keys", model.keys},         {"clusters", model.clusters}};
      row.update(technique_row(technique));
      std::string names, values;
      for (const auto& [name, value] : row.items()) {
        if (!names.empty()) {
          names += ',';
          values += ',';
        }
        names += name;
        values += csv_cell(value.is_string() ? value.get<std::string>() : value.dump());
      }
      header = names + "\n";
      lines += values + "\n";
    }
  return header + lines;
}

}  // namespace mdk
