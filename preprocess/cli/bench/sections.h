// The sections of a report, each from the results it is about; those with nothing to show say why.
#pragma once

#include <string>
#include <vector>

#include "preprocess/cli/bench/report.h"
#include "preprocess/cli/bench/results.h"

namespace mdk {

// Fuzzy structures beside their peers, in every run (summary_sections.cpp).
Section summary_section(const BenchResults& results);
Section machine_section(const BenchResults& results);
/// One row per technique for each of these models: README's table.
Table technique_table_of(const BenchRun& run, const std::vector<std::string>& models);

// GFW06 (gfw06_sections.cpp).
Section gfw06_table1_section(const BenchRun& run);
Section gfw06_figure7_section(const BenchRun& run);
Section gfw06_figure8_section(const BenchRun& run);

// Lo09 (lo09_sections.cpp).
Section lo09_table1_section(const BenchRun& run);
std::vector<Section> lo09_figure_sections(const BenchRun& run);

// Past the papers (scaling_sections.cpp).
Section crossover_section(const BenchRun& run);
Section memory_section(const BenchRun& run);
Section bake_section(const BenchRun& run);

// Every figure of the first run, and how it was taken (detail_sections.cpp).
Section detail_section(const BenchRun& run);
Section method_section(const BenchResults& results);

/// The technique with the least median time to image among those with these ids, or null.
const TechniqueBench* fastest_of(const ModelBench& model, const std::vector<std::string>& ids);

/// Names of models, subdivided ones ("hand-split2") aside: those that plots over time show.
std::vector<const ModelBench*> whole_models(const BenchRun& run);

/// What a figure over frames draws: every technique but Embree's single modes where its best is
/// there.
std::vector<const TechniqueBench*> drawn_techniques(const ModelBench& model);

}  // namespace mdk
