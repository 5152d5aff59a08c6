#include "preprocess/cli/bench/report.h"

#include <algorithm>

#include "preprocess/cli/bench/sections.h"

namespace mdk {
namespace {

std::string or_unknown(const std::string& text) { return text.empty() ? "not given" : text; }

std::vector<std::pair<std::string, std::string>> facts_of(const BenchResults& results) {
  const BenchRun& run = results.runs.front();
  const std::size_t frames = run.models.front().techniques.front().frames.size();
  const std::size_t rounds = run.models.front().techniques.front().round_medians_ms.size();
  return {
      {"Machine", or_unknown(results.machine.cpu) + ", " + std::to_string(results.machine.cores) +
                      (results.machine.cores == 1 ? " core" : " cores")},
      {"Instruction set", run.isa},
      {"Threads", std::to_string(run.threads)},
      {"Picture", std::to_string(run.width) + " x " + std::to_string(run.height) + ", shading " +
                      or_unknown(run.shading)},
      {"Frames", std::to_string(frames) + " keys of the first model, each timed in " +
                     std::to_string(rounds) + (rounds == 1 ? " round" : " rounds")},
      {"Program",
       "mdprep " + results.program.version + ", commit " + or_unknown(results.program.commit)},
      {"Compiler", or_unknown(results.program.compiler)},
      {"Command", "`" + or_unknown(results.command) + "`"}};
}

}  // namespace

Report make_report(const BenchResults& results) {
  const BenchRun& run = results.runs.front();
  Report report;
  report.title = "Ray tracing animated meshes: every technique, measured";
  report.facts = facts_of(results);
  report.sections = {summary_section(results), gfw06_table1_section(run),
                     gfw06_figure7_section(run), gfw06_figure8_section(run),
                     lo09_table1_section(run)};
  for (Section& section : lo09_figure_sections(run)) report.sections.push_back(std::move(section));
  report.sections.push_back(crossover_section(run));
  report.sections.push_back(memory_section(run));
  report.sections.push_back(bake_section(run));
  if (results.runs.size() > 1) report.sections.push_back(machine_section(results));
  report.sections.push_back(detail_section(run));
  report.sections.push_back(method_section(results));
  return report;
}

std::vector<std::pair<std::string, std::string>> legend_of(const Figure& figure) {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const Chart& chart : figure.charts)
    for (const ChartSeries& series : chart.series) {
      std::pair<std::string, std::string> entry{series.label, series.style};
      if (std::find(entries.begin(), entries.end(), entry) == entries.end())
        entries.push_back(std::move(entry));
    }
  return entries;
}

const TechniqueBench* fastest_of(const ModelBench& model, const std::vector<std::string>& ids) {
  const TechniqueBench* best = nullptr;
  for (const std::string& id : ids) {
    const TechniqueBench* technique = model.find(id);
    if (technique == nullptr) continue;
    if (best == nullptr || technique->time_to_image_ms().median < best->time_to_image_ms().median)
      best = technique;
  }
  return best;
}

std::vector<const ModelBench*> whole_models(const BenchRun& run) {
  std::vector<const ModelBench*> models;
  for (const ModelBench& model : run.models)
    if (model.name().find("-split") == std::string::npos) models.push_back(&model);
  return models;
}

std::vector<const TechniqueBench*> drawn_techniques(const ModelBench& model) {
  std::vector<const TechniqueBench*> drawn;
  const bool has_best = model.find("embree") != nullptr;
  for (const TechniqueBench& technique : model.techniques)
    if (!has_best || technique.id.rfind("embree-", 0) != 0) drawn.push_back(&technique);
  return drawn;
}

}  // namespace mdk
