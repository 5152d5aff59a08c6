#include "preprocess/cli/bench/comparison.h"

#include <algorithm>
#include <map>
#include <ostream>

#include "common/base/error.h"
#include "preprocess/cli/number_text.h"
#include "preprocess/cli/text_table.h"

namespace mdk {
namespace {

constexpr double kLeastUnrest = 0.01;  // what code placement alone can do between two builds

std::string setting_of(const BenchRun& run) {
  return run.isa + ", " + std::to_string(run.threads) +
         (run.threads == 1 ? " thread, " : " threads, ") + std::to_string(run.width) + "x" +
         std::to_string(run.height) + ", " + run.shading;
}

double count_ratio(double before, double after) {
  if (before == after) return 1;
  return before > 0 ? after / before : 0;
}

/// New / old for each key that both have.
std::vector<double> ratios_by_key(const TechniqueBench& before, const TechniqueBench& after) {
  std::map<std::uint32_t, double> old_ms;
  for (const BenchFrame& frame : before.frames) old_ms[frame.key] = frame.time_to_image_ms();
  std::vector<double> ratios;
  for (const BenchFrame& frame : after.frames) {
    const auto found = old_ms.find(frame.key);
    if (found != old_ms.end() && found->second > 0)
      ratios.push_back(frame.time_to_image_ms() / found->second);
  }
  return ratios;
}

Verdict judge(const Quartiles& ratio) {
  if (ratio.high < 1) return Verdict::kFaster;
  return ratio.low > 1 ? Verdict::kSlower : Verdict::kSame;
}

ComparedTechnique compare_technique(const TechniqueBench& before, const TechniqueBench& after) {
  ComparedTechnique row;
  row.id = before.id;
  row.old_ms = before.time_to_image_ms().median;
  row.new_ms = after.time_to_image_ms().median;
  row.ratio = quartiles(ratios_by_key(before, after));
  const double unrest = std::max(kLeastUnrest, (before.unrest() + after.unrest()) / 2);
  row.ratio.low /= 1 + unrest;
  row.ratio.high *= 1 + unrest;
  row.verdict = judge(row.ratio);
  row.visits_ratio = count_ratio(before.work().node_visits, after.work().node_visits);
  row.tests_ratio = count_ratio(before.work().triangle_tests, after.work().triangle_tests);
  return row;
}

const char* verdict_text(Verdict verdict) {
  if (verdict == Verdict::kFaster) return "faster";
  return verdict == Verdict::kSlower ? "slower" : "same";
}

std::string count_text(double ratio) { return ratio == 1 ? "same" : fixed_text(ratio, 3); }

}  // namespace

std::vector<ComparedTechnique> compare_results(const BenchResults& before,
                                               const BenchResults& after) {
  std::vector<ComparedTechnique> rows;
  for (const BenchRun& old_run : before.runs)
    for (const BenchRun& new_run : after.runs) {
      if (setting_of(old_run) != setting_of(new_run)) continue;
      for (const ModelBench& old_model : old_run.models) {
        const ModelBench* new_model = new_run.find(old_model.name());
        if (new_model == nullptr) continue;
        for (const TechniqueBench& technique : old_model.techniques) {
          const TechniqueBench* other = new_model->find(technique.id);
          if (other == nullptr || ratios_by_key(technique, *other).empty()) continue;
          rows.push_back(compare_technique(technique, *other));
          rows.back().setting = setting_of(old_run);
          rows.back().model = old_model.name();
        }
      }
    }
  if (rows.empty())
    throw Error(ErrorCode::kBadInput,
                "the two results have no model, technique and key in common that was measured at "
                "the same size, instruction set, threads and shading: give both the same options");
  return rows;
}

void print_comparison(std::ostream& out, const std::vector<ComparedTechnique>& rows) {
  std::string setting;
  int faster = 0, same = 0, slower = 0;
  TextTable table(2);
  const auto flush = [&] {
    if (setting.empty()) return;
    out << setting << "\n";
    table.print(out);
    table = TextTable(2);
  };
  for (const ComparedTechnique& row : rows) {
    if (row.setting != setting) {
      flush();
      setting = row.setting;
      table.add_row({"model", "technique", "old ms", "new ms", "new/old", "spread", "verdict",
                     "visits", "tests"});
    }
    faster += row.verdict == Verdict::kFaster;
    same += row.verdict == Verdict::kSame;
    slower += row.verdict == Verdict::kSlower;
    table.add_row({row.model, row.id, fixed_text(row.old_ms, 2), fixed_text(row.new_ms, 2),
                   fixed_text(row.ratio.median, 3),
                   fixed_text(row.ratio.low, 3) + "-" + fixed_text(row.ratio.high, 3),
                   verdict_text(row.verdict), count_text(row.visits_ratio),
                   count_text(row.tests_ratio)});
  }
  flush();
  out << faster << " faster, " << same << " the same, " << slower << " slower\n";
}

}  // namespace mdk
