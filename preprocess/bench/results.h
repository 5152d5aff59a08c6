// What benches found out, as plain data: measuring fills it in, files hold it, pages show it.
//
//     BenchResults   one machine and one program, one or more runs
//       BenchRun     one setting: instruction set, number of threads, picture size, shading
//         ModelBench     one .mdk file, with what its bake reported
//           TechniqueBench   one technique on it
//             BenchFrame         one key: times of its fastest round, counts of the counting pass
//
// A new field is a member here and a line in result_json.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/trace/frame_stats.h"
#include "preprocess/pipeline.h"
#include "preprocess/tool/measures.h"

namespace mdk {

struct BenchFrame {
  std::uint32_t key = 0;
  double pose_ms = 0, update_ms = 0, trace_ms = 0, shade_ms = 0;
  TraceCounters counters;             ///< all zero for peers
  std::uint64_t hits = 0;             ///< rays that hit; 0 in results of older programs
  std::uint64_t structure_bytes = 0;  ///< once this frame and those before it had been counted

  double time_to_image_ms() const { return pose_ms + update_ms + trace_ms + shade_ms; }
};

/// The middle half of some values.
struct Quartiles {
  double low = 0, median = 0, high = 0;
};
/// By linear interpolation between neighbours in order; zeros for none.
Quartiles quartiles(std::vector<double> values);

/// How many of `milliseconds` fit into a second; 0 for no time.
inline double per_second(double milliseconds) { return milliseconds > 0 ? 1000 / milliseconds : 0; }

struct TechniqueBench {
  std::string id;
  std::vector<BenchFrame> frames;
  std::vector<double> round_medians_ms;  ///< time to image, median over the frames of each round
  std::uint64_t rays_per_frame = 0;
  std::uint64_t structure_bytes = 0;
  double prebuild_ms = 0;            ///< all work ahead of time for these keys
  std::uint64_t judged_frames = 0;   ///< compared with brute force
  std::uint64_t hit_mismatches = 0;  ///< in those, by what the technique promises (TechniqueInfo)
  std::string note;                  ///< of the technique after its last frame, or empty
  double kd_cost_ratio = 0;  ///< TechniqueInfo's; 0 where there is no kd-tree or the file is older

  /// Of one phase, over the frames.
  double median_ms(double BenchFrame::*phase) const;
  /// A median of its own, not the sum of the others. The quartiles are over the animation.
  Quartiles time_to_image_ms() const;
  double fps() const { return per_second(time_to_image_ms().median); }
  /// How far the second fastest round's median lies behind the fastest's, as a share of it: what
  /// the fastest of the rounds can be trusted to. 0 for a single round.
  double round_spread() const;
  WorkPerRay work() const;
  /// The same, divided by the rays that hit; zeros where hits were not counted.
  WorkPerRay work_per_hit() const;
  double hits_per_frame() const;  ///< mean; 0 where they were not counted
  /// False for results of a program that did not count the triangles of leaves.
  bool has_leaf_counts() const;
};

/// What `mdprep bake --report` says of a file.
struct BakeFacts {
  struct Seconds {
    double read = 0, decompose = 0, build = 0, write = 0, total = 0;
  };
  std::uint32_t segments = 0;
  std::string stop_reason;
  double residual_rms = 0, residual_max = 0, sah_cost = 0;
  Seconds seconds;
  std::uint64_t peak_memory_bytes = 0, file_bytes = 0;
  std::vector<GrowthStep> growth;
};

struct ModelBench {
  std::string file;  ///< as given on the command line
  std::uint32_t triangles = 0, keys = 0, clusters = 0;
  std::optional<BakeFacts> bake;
  std::vector<TechniqueBench> techniques;
  bool between_keys = true;   ///< whether its boxes hold there
  double predicted_cost = 0;  ///< see predicted_cost() of the model; 0: not known

  /// The file's name without folder and ending.
  std::string name() const;
  const TechniqueBench* find(std::string_view id) const;  ///< or null
};

struct BenchSetting {
  std::string isa;
  int threads = 0;
  std::uint32_t width = 0, height = 0;
  std::string shading;
  bool operator==(const BenchSetting&) const = default;
};

struct BenchRun {
  BenchSetting setting;
  std::vector<ModelBench> models;

  const ModelBench* find(std::string_view name) const;  ///< or null
};

struct BenchMachine {
  std::string cpu;
  int cores = 0;
  bool operator==(const BenchMachine&) const = default;
};

struct BenchProgram {
  std::string version;   ///< of mdprep
  std::string commit;    ///< as --commit gave it, or empty
  std::string compiler;  ///< name, version and flags
  bool operator==(const BenchProgram&) const = default;
};

struct BenchResults {
  BenchMachine machine;
  BenchProgram program;
  std::string command;         ///< how it was started
  std::vector<BenchRun> runs;  ///< at least one; the first is the one that pages show in full
};

/// Adds runs of the same program. A run with the setting of one that is there goes into it: models
/// it does not have are appended; of models it has, techniques are appended, and the frames of
/// techniques it has too count as further rounds. Throws Error (kBadInput) naming `origin` where a
/// frame, a count or a machine differs.
void merge_results(BenchResults& into, BenchResults more, const std::string& origin);

/// Takes over another round's times where its time to image is shorter.
void keep_faster(BenchFrame& frame, const BenchFrame& another);

/// As a file, schema "mdprep-bench/1". The first run's fields stand at the top, where scripts look
/// for them; other runs are in "further_runs". Medians are there for scripts; everything else
/// follows from the frames.
std::string results_json(const BenchResults& results);

/// The inverse of results_json. Throws Error: kIo, or kBadInput naming what is missing or wrong.
BenchResults read_results(const std::string& path);
/// `origin` stands for the file in what is thrown.
BenchResults parse_results(std::string_view text, const std::string& origin);

/// What the report beside a file says ("a.json" or "a.bake.json" beside "a.mdk", schema
/// "mdprep-bake/1"), or nothing where there is none or it is about another model.
std::optional<BakeFacts> read_bake_facts(const std::string& mdk_path, std::uint32_t triangles,
                                         std::uint32_t keys, std::uint32_t clusters);

}  // namespace mdk
