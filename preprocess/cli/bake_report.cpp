#include "preprocess/cli/bake_report.h"

#include <nlohmann/json.hpp>

#include "common/base/printable_text.h"
#include "preprocess/cli/number_text.h"

namespace mdk {
namespace {

std::string stop_text(const std::string& reason) {
  if (reason == "cost") return "another would cost more than it saves";
  if (reason == "percent") return "another would gain less than the percentage";
  if (reason == "count") return "as many as asked for";
  if (reason == "bones") return "those of bones that have triangles";
  if (reason == "limit") return "the most there may be";
  return "no decomposition";
}

}  // namespace

std::string bake_report_json(const Model& model, const DecomposeStats& stats,
                             const BakeOutcome& outcome) {
  using Json = nlohmann::ordered_json;
  Json clips = Json::array();
  for (const Clip& clip : model.clips)
    clips.push_back(
        {{"name", clip.name}, {"seconds", model.clip_seconds(clip)}, {"keys", clip.key_count}});
  Json quantization = nullptr;
  if (stats.quantization)
    quantization = {{"bound", stats.quantization->bound}, {"largest", stats.quantization->largest}};
  const Json read_through =
      outcome.read_through.empty() ? Json(nullptr) : Json(outcome.read_through);
  Json growth = Json::array();
  for (const ClusteringStep& step : stats.steps)
    growth.push_back({{"clusters", step.clusters},
                      {"residual_rms", step.residual_rms},
                      {"fuzzy_area", step.fuzzy_area},
                      {"sah_cost", step.sah_cost}});
  const Json report = {
      {"schema", "mdprep-bake/1"},
      {"input", outcome.input},
      {"read_through", read_through},
      {"triangles", model.triangle_count()},
      {"vertices", model.vertex_count},
      {"keys", model.key_count()},
      {"clips", clips},
      {"clusters", model.cluster_count()},
      {"segments", model.segment_count()},
      {"rest_key", stats.rest_key},
      {"stop_reason", stats.stop_reason},
      {"residual_rms", stats.residual_rms},
      {"residual_max", stats.residual_max},
      {"quantization", quantization},
      {"sah_cost", stats.sah_cost},
      {"refine_gain", stats.refine_gain},
      {"seconds",
       {{"read", outcome.seconds.read},
        {"decompose", outcome.seconds.decompose},
        {"build", outcome.seconds.build},
        {"write", outcome.seconds.write},
        {"total", outcome.seconds.total}}},
      {"peak_memory_bytes", outcome.peak_memory_bytes},
      {"file_bytes", outcome.file_bytes},
      {"growth", growth},
  };
  return report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string bake_summary(const Model& model, const DecomposeStats& stats,
                         const BakeOutcome& outcome) {
  const auto count = [](std::uint64_t n, const std::string& thing) {
    return grouped_text(n) + " " + thing + (n == 1 ? "" : "s");
  };
  const auto percent = [](double share) { return fixed_text(share * 100, 3) + " %"; };
  const BakeSeconds& s = outcome.seconds;
  return printable_line(outcome.output) + ": " + count(model.triangle_count(), "triangle") + ", " +
         grouped_text(model.vertex_count) + " vertices, " + count(model.key_count(), "key") +
         " in " + count(model.clips.size(), "clip") + "\n  " +
         count(model.cluster_count(), "cluster") + " (" + stop_text(stats.stop_reason) + "), " +
         count(model.segment_count(), "time segment") + ", rest pose key " +
         std::to_string(stats.rest_key) + ", residual " + percent(stats.residual_rms) + " rms, " +
         percent(stats.residual_max) + " at most of the diagonal, cost " +
         fixed_text(stats.sah_cost, 1) + "\n  " + bytes_text(outcome.file_bytes) + " in " +
         fixed_text(s.total, 2) + " s (read " + fixed_text(s.read, 2) + ", decompose " +
         fixed_text(s.decompose, 2) + ", build " + fixed_text(s.build, 2) + ", write " +
         fixed_text(s.write, 2) + "), peak memory " + bytes_text(outcome.peak_memory_bytes) +
         (outcome.scratch_bytes > 0
              ? std::string(" with mapped files, ") + bytes_text(outcome.scratch_bytes) +
                    " of them for long lists\n"
              : "\n");
}

}  // namespace mdk
