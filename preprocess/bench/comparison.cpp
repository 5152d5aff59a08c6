#include "preprocess/bench/comparison.h"

#include <algorithm>
#include <map>
#include <ostream>

#include "common/base/error.h"
#include "common/base/text.h"
#include "preprocess/bench/report.h"

namespace mdk {
namespace {

constexpr double kMinSpread = 0.01;  // what code placement alone can do between two builds

std::string setting_text(const BenchSetting& setting) {
  return setting.isa + ", " + std::to_string(setting.threads) +
         (setting.threads == 1 ? " thread, " : " threads, ") + std::to_string(setting.width) + "x" +
         std::to_string(setting.height) + ", " + setting.shading;
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

const char* verdict_text(Verdict verdict) {
  if (verdict == Verdict::kFaster) return "faster";
  return verdict == Verdict::kSlower ? "slower" : "same";
}

std::string count_text(double ratio) { return ratio == 1 ? "same" : fixed_text(ratio, 3); }

/// Adds what the two results of a model have in common.
void compare_models(const std::string& setting, const ModelBench& before, const ModelBench& after,
                    std::vector<ComparedTechnique>& rows) {
  for (const TechniqueBench& old_one : before.techniques) {
    const TechniqueBench* new_one = after.find(old_one.id);
    if (new_one == nullptr) continue;
    const std::vector<double> ratios = ratios_by_key(old_one, *new_one);
    if (ratios.empty()) continue;
    Quartiles ratio = quartiles(ratios);
    const double spread =
        std::max(kMinSpread, (old_one.round_spread() + new_one->round_spread()) / 2);
    ratio.low /= 1 + spread;
    ratio.high *= 1 + spread;
    const WorkPerRay old_work = old_one.work(), new_work = new_one->work();
    rows.push_back({setting, before.name(), old_one.id, old_one.time_to_image_ms().median,
                    new_one->time_to_image_ms().median, ratio, judge(ratio),
                    count_ratio(old_work.node_visits, new_work.node_visits),
                    count_ratio(old_work.triangle_tests, new_work.triangle_tests)});
  }
}

Table comparison_table(const std::vector<ComparedTechnique>& rows) {
  return table_of<ComparedTechnique>(
      "", rows,
      {{"model", [](auto& r) { return r.model; }},
       {"technique", [](auto& r) { return r.id; }},
       {"old ms", [](auto& r) { return fixed_text(r.old_ms, 2); }},
       {"new ms", [](auto& r) { return fixed_text(r.new_ms, 2); }},
       {"new/old", [](auto& r) { return fixed_text(r.ratio.median, 3); }},
       {"spread",
        [](auto& r) { return fixed_text(r.ratio.low, 3) + "-" + fixed_text(r.ratio.high, 3); }},
       {"verdict", [](auto& r) { return verdict_text(r.verdict); }},
       {"visits", [](auto& r) { return count_text(r.visits_ratio); }},
       {"tests", [](auto& r) { return count_text(r.tests_ratio); }}},
      2);
}

}  // namespace

std::vector<ComparedTechnique> compare_results(const BenchResults& before,
                                               const BenchResults& after) {
  std::vector<ComparedTechnique> rows;
  for (const BenchRun& old_run : before.runs)
    for (const BenchRun& new_run : after.runs) {
      if (old_run.setting != new_run.setting) continue;
      for (const ModelBench& model : old_run.models)
        if (const ModelBench* same = new_run.find(model.name()))
          compare_models(setting_text(old_run.setting), model, *same, rows);
    }
  if (rows.empty())
    throw Error(ErrorCode::kBadInput,
                "the two results have no model, technique and key in common that was measured at "
                "the same size, instruction set, threads and shading: give both the same options");
  return rows;
}

void print_comparison(std::ostream& out, const std::vector<ComparedTechnique>& rows) {
  for (auto begin = rows.begin(); begin != rows.end();) {
    const auto end = std::find_if(begin, rows.end(), [&](const ComparedTechnique& row) {
      return row.setting != begin->setting;
    });
    out << begin->setting << "\n";
    print_table(out, comparison_table({begin, end}));
    begin = end;
  }
  const auto count = [&](Verdict verdict) {
    return std::count_if(rows.begin(), rows.end(),
                         [&](const ComparedTechnique& row) { return row.verdict == verdict; });
  };
  out << count(Verdict::kFaster) << " faster, " << count(Verdict::kSame) << " the same, "
      << count(Verdict::kSlower) << " slower\n";
}

}  // namespace mdk
