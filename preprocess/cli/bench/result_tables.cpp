#include "preprocess/cli/bench/result_tables.h"

#include <charconv>
#include <ostream>
#include <span>
#include <utility>
#include <vector>

#include "preprocess/cli/number_text.h"
#include "preprocess/cli/text_table.h"

namespace mdk {
namespace {

std::vector<std::string> table_row(const std::string& model, const TechniqueBench& technique) {
  const Quartiles image = technique.time_to_image_ms();
  const WorkPerRay work = technique.work();
  return {model,
          technique.id,
          fixed_text(technique.median_pose_ms(), 2),
          fixed_text(technique.median_update_ms(), 2),
          fixed_text(technique.median_trace_ms(), 2),
          fixed_text(technique.median_shade_ms(), 2),
          fixed_text(image.median, 2),
          fixed_text(image.low, 2) + "-" + fixed_text(image.high, 2),
          fixed_text(image.median > 0 ? 1000 / image.median : 0, 1),
          fixed_text(work.node_visits, 3),
          fixed_text(work.triangle_tests, 3),
          fixed_text(work.clusters, 3),
          bytes_text(technique.structure_bytes),
          fixed_text(technique.prebuild_ms, 1),
          std::to_string(technique.hit_mismatches)};
}

/// Quoted where it must be (RFC 4180).
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

/// The shortest text that reads as the same number.
std::string exact_text(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

using Cells = std::vector<std::pair<const char*, std::string>>;

Cells csv_cells(const BenchRun& run, const ModelBench& model, const TechniqueBench& technique) {
  const Quartiles image = technique.time_to_image_ms();
  const WorkPerRay work = technique.work();
  return {{"file", model.file},
          {"isa", run.isa},
          {"threads", std::to_string(run.threads)},
          {"width", std::to_string(run.width)},
          {"height", std::to_string(run.height)},
          {"triangles", std::to_string(model.triangles)},
          {"keys", std::to_string(model.keys)},
          {"clusters", std::to_string(model.clusters)},
          {"id", technique.id},
          {"pose_ms", exact_text(technique.median_pose_ms())},
          {"update_ms", exact_text(technique.median_update_ms())},
          {"trace_ms", exact_text(technique.median_trace_ms())},
          {"shade_ms", exact_text(technique.median_shade_ms())},
          {"time_to_image_ms", exact_text(image.median)},
          {"fps", exact_text(image.median > 0 ? 1000 / image.median : 0)},
          {"node_visits_per_ray", exact_text(work.node_visits)},
          {"triangle_tests_per_ray", exact_text(work.triangle_tests)},
          {"clusters_per_ray", exact_text(work.clusters)},
          {"structure_bytes", std::to_string(technique.structure_bytes)},
          {"prebuild_ms", exact_text(technique.prebuild_ms)},
          {"hit_mismatches", std::to_string(technique.hit_mismatches)},
          {"time_to_image_low_ms", exact_text(image.low)},
          {"time_to_image_high_ms", exact_text(image.high)},
          {"unrest", exact_text(technique.unrest())}};
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) line.append(line.empty() ? "" : ",").append(csv_cell(cell));
  return line + "\n";
}

}  // namespace

void print_bench_table(std::ostream& out, const BenchRun& run) {
  TextTable table(2);
  table.add_row({"model", "technique", "pose ms", "update ms", "trace ms", "shade ms", "image ms",
                 "middle half", "fps", "visits/ray", "tests/ray", "clusters/ray", "memory",
                 "prebuild ms", "mismatches"});
  for (const ModelBench& model : run.models)
    for (const TechniqueBench& technique : model.techniques)
      table.add_row(table_row(model.name(), technique));
  table.print(out);
  for (const ModelBench& model : run.models)
    for (const TechniqueBench& technique : model.techniques)
      if (!technique.note.empty())
        out << model.name() << " " << technique.id << ": " << technique.note << "\n";
}

std::string results_csv(const BenchResults& results) {
  std::string header, lines;
  for (const BenchRun& run : results.runs)
    for (const ModelBench& model : run.models)
      for (const TechniqueBench& technique : model.techniques) {
        std::vector<std::string> names, values;
        for (auto& [name, value] : csv_cells(run, model, technique)) {
          names.emplace_back(name);
          values.push_back(std::move(value));
        }
        header = csv_line(names);
        lines += csv_line(values);
      }
  return header + lines;
}

}  // namespace mdk
