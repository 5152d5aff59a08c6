#include "preprocess/bench/results.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "common/base/error.h"
#include "preprocess/tool/measures.h"

namespace mdk {
namespace {

[[noreturn]] void refuse(const std::string& origin, const std::string& what) {
  throw Error(ErrorCode::kBadInput, origin + ": " + what);
}

/// Appends each of `more`, or merges it into the one of `into` that has the same name.
template <class Item, class Name, class Merge>
void merge_lists(std::vector<Item>& into, std::vector<Item>& more, const Name& name_of,
                 const Merge& merge) {
  for (Item& item : more) {
    const auto same = std::find_if(into.begin(), into.end(), [&](const Item& other) {
      return name_of(other) == name_of(item);
    });
    if (same == into.end()) {
      into.push_back(std::move(item));
    } else {
      merge(*same, item);
    }
  }
}

void merge_technique(TechniqueBench& into, const TechniqueBench& more, const std::string& place) {
  if (into.frames.size() != more.frames.size() || into.rays_per_frame != more.rays_per_frame)
    refuse(place, "has other frames than the results before it; render the same keys and size");
  for (std::size_t i = 0; i < into.frames.size(); ++i) {
    if (into.frames[i].key != more.frames[i].key)
      refuse(place, "has other keys than the results before it; give all the same --frames");
    keep_faster(into.frames[i], more.frames[i]);
  }
  into.round_medians_ms.insert(into.round_medians_ms.end(), more.round_medians_ms.begin(),
                               more.round_medians_ms.end());
  into.judged_frames = std::max(into.judged_frames, more.judged_frames);
  into.hit_mismatches = std::max(into.hit_mismatches, more.hit_mismatches);
  into.prebuild_ms = std::min(into.prebuild_ms, more.prebuild_ms);
}

void merge_model(ModelBench& into, ModelBench& more, const std::string& origin) {
  const std::string place = origin + ", " + more.name();
  if (into.triangles != more.triangles || into.keys != more.keys || into.clusters != more.clusters)
    refuse(place, "is another model than the one of this name in the results before it");
  if (!into.bake) into.bake = std::move(more.bake);
  merge_lists(
      into.techniques, more.techniques, [](const TechniqueBench& t) { return t.id; },
      [&](TechniqueBench& a, TechniqueBench& b) { merge_technique(a, b, place + ", " + b.id); });
}

}  // namespace

Quartiles quartiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    const double place = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
  };
  return {at(0.25), at(0.5), at(0.75)};
}

double TechniqueBench::median_ms(double BenchFrame::*phase) const {
  std::vector<double> values;
  for (const BenchFrame& frame : frames) values.push_back(frame.*phase);
  return median(std::move(values));
}

Quartiles TechniqueBench::time_to_image_ms() const {
  std::vector<double> values;
  for (const BenchFrame& frame : frames) values.push_back(frame.time_to_image_ms());
  return quartiles(std::move(values));
}

double TechniqueBench::round_spread() const {
  if (round_medians_ms.size() < 2) return 0;
  std::vector<double> rounds = round_medians_ms;
  std::nth_element(rounds.begin(), rounds.begin() + 1, rounds.end());
  const double fastest = rounds[0];  // all before the second are not larger
  return fastest > 0 ? (rounds[1] - fastest) / fastest : 0;
}

WorkPerRay TechniqueBench::work() const {
  TraceCounters sum;
  for (const BenchFrame& frame : frames) sum += frame.counters;
  return work_per_ray(sum, rays_per_frame * frames.size());
}

WorkPerRay TechniqueBench::work_per_hit() const {
  TraceCounters sum;
  std::uint64_t hits = 0;
  for (const BenchFrame& frame : frames) {
    sum += frame.counters;
    hits += frame.hits;
  }
  return hits > 0 ? work_per_ray(sum, hits) : WorkPerRay{};
}

double TechniqueBench::hits_per_frame() const {
  double hits = 0;
  for (const BenchFrame& frame : frames) hits += static_cast<double>(frame.hits);
  return frames.empty() ? 0 : hits / static_cast<double>(frames.size());
}

bool TechniqueBench::has_leaf_counts() const {
  const WorkPerRay counted = work();
  return counted.leaf_triangles > 0 || counted.triangle_tests == 0;
}

std::string ModelBench::name() const { return std::filesystem::path(file).stem().string(); }

const TechniqueBench* ModelBench::find(std::string_view id) const {
  for (const TechniqueBench& technique : techniques)
    if (technique.id == id) return &technique;
  return nullptr;
}

const ModelBench* BenchRun::find(std::string_view name) const {
  for (const ModelBench& model : models)
    if (model.name() == name) return &model;
  return nullptr;
}

void keep_faster(BenchFrame& frame, const BenchFrame& another) {
  if (!(another.time_to_image_ms() < frame.time_to_image_ms())) return;
  frame.pose_ms = another.pose_ms;
  frame.update_ms = another.update_ms;
  frame.trace_ms = another.trace_ms;
  frame.shade_ms = another.shade_ms;
}

void merge_results(BenchResults& into, BenchResults more, const std::string& origin) {
  if (into.runs.empty()) {
    into = std::move(more);
    return;
  }
  if (into.machine != more.machine)
    refuse(origin, "was measured on another machine than the results before it");
  if (into.program != more.program)
    refuse(origin, "was measured with another program than the results before it");
  merge_lists(
      into.runs, more.runs, [](const BenchRun& run) { return run.setting; },
      [&](BenchRun& run, BenchRun& further) {
        merge_lists(
            run.models, further.models, [](const ModelBench& model) { return model.name(); },
            [&](ModelBench& a, ModelBench& b) { merge_model(a, b, origin); });
      });
}

}  // namespace mdk
