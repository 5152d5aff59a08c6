// Predicted against measured: whether the decomposition's cost says what tracing takes.
#include <utility>
#include <vector>

#include "common/base/text.h"
#include "preprocess/bench/report.h"

namespace mdk {

/// Each model a point: what the cost expects of a ray that meets it, and how long one that hits it
/// took.
Section predicted_cost_section(const BenchRun& run) {
  Chart chart{.title = "fuzzy-bvh",
              .x_label = "predicted cost",
              .y_label = "trace time, ns per ray that hits",
              .x_scale = Scale::kLog,
              .y_scale = Scale::kLog,
              .labels = Labels::kAtEnd,
              .marks = Marks::kDots};
  std::vector<double> predicted, measured;
  for (const ModelBench& model : run.models) {
    const TechniqueBench* fuzzy = model.find("fuzzy-bvh");
    if (fuzzy == nullptr || !(model.predicted_cost > 0)) continue;
    const double hits = fuzzy->hits_per_frame();
    if (!(hits > 0)) continue;
    predicted.push_back(model.predicted_cost);
    measured.push_back(1e6 * fuzzy->median_ms(&BenchFrame::trace_ms) / hits);
    chart.series.push_back(
        {model.name(), numbered_style(chart.series.size()), {{predicted.back(), measured.back()}}});
  }
  std::vector<Chart> charts;
  std::string caption =
      "What the decomposition expects of a ray that meets the model (docs/method.md, cost) against "
      "the median trace time of `fuzzy-bvh`, divided by the rays that hit.";
  if (predicted.size() > 2)
    caption += " Rank correlation of the two over these models: " +
               fixed_text(rank_correlation(predicted, measured), 2) + ".";
  if (!chart.series.empty()) charts.push_back(std::move(chart));
  return figure_section({.id = "predicted-cost",
                         .caption = caption,
                         .charts = std::move(charts),
                         .has_legend = false},
                        "Predicted against measured",
                        "Needs `fuzzy-bvh` measured, by a program that counts hits.");
}

}  // namespace mdk
