// What benches found out, as plain data: measuring fills it in, files hold it, pages show it.
//
//     BenchResults   one machine and one program, one or more runs
//       BenchRun     one instruction set, number of threads and picture size
//         ModelBench     one .mdk file, with what its bake reported
//           TechniqueBench   one technique on it
//             BenchFrame         one key: times of its fastest round, counts of the counting pass
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/trace/frame_stats.h"
#include "preprocess/cli/work_per_ray.h"

namespace mdk {

struct BenchFrame {
  std::uint32_t key = 0;
  double pose_ms = 0, update_ms = 0, trace_ms = 0, shade_ms = 0;
  TraceCounters counters;             ///< all zero for peers
  std::uint64_t structure_bytes = 0;  ///< once this frame and those before it had been counted

  double time_to_image_ms() const { return pose_ms + update_ms + trace_ms + shade_ms; }
};

/// The middle half of some values.
struct Quartiles {
  double low = 0, median = 0, high = 0;
};
/// By linear interpolation between neighbours in order; zeros for none.
Quartiles quartiles(std::vector<double> values);

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

  double median_pose_ms() const;
  double median_update_ms() const;
  double median_trace_ms() const;
  double median_shade_ms() const;
  /// A median of its own, not the sum of the others. The quartiles are over the animation.
  Quartiles time_to_image_ms() const;
  /// How far the second fastest round's median lies behind the fastest's, as a share of it: what
  /// the fastest of the rounds can be trusted to. 0 for a single round.
  double unrest() const;
  WorkPerRay work() const;
};

/// What happened while clusters were added (GFW06 Figure 7).
struct GrowthRow {
  std::uint32_t clusters = 0;
  double residual_rms = 0, fuzzy_area = 0, sah_cost = 0;
};

/// What `mdprep bake --report` told of a file.
struct BakeFacts {
  std::uint32_t segments = 0;
  std::string stop_reason;
  double residual_rms = 0, residual_max = 0, sah_cost = 0;
  double read_s = 0, decompose_s = 0, build_s = 0, write_s = 0, total_s = 0;
  std::uint64_t peak_memory_bytes = 0, file_bytes = 0;
  std::vector<GrowthRow> growth;
};

struct ModelBench {
  std::string file;  ///< as given on the command line
  std::uint32_t triangles = 0, keys = 0, clusters = 0;
  std::optional<BakeFacts> bake;
  std::vector<TechniqueBench> techniques;

  /// The file's name without folder and ending.
  std::string name() const;
  const TechniqueBench* find(std::string_view id) const;  ///< or null
};

struct BenchRun {
  std::string isa;
  int threads = 0;
  std::uint32_t width = 0, height = 0;
  std::string shading;
  std::vector<ModelBench> models;

  const ModelBench* find(std::string_view name) const;  ///< or null
};

struct BenchMachine {
  std::string cpu;
  int cores = 0;
};

struct BenchProgram {
  std::string version;   ///< of mdprep
  std::string commit;    ///< as --commit gave it, or empty
  std::string compiler;  ///< name, version and flags
};

struct BenchResults {
  BenchMachine machine;
  BenchProgram program;
  std::string command;         ///< how it was started
  std::vector<BenchRun> runs;  ///< at least one; the first is the one that pages show in full
};

/// Adds runs of the same program. A run with the isa, threads, size and shading of one that is
/// there goes into it: models it does not have are appended; of models it has, techniques are
/// appended, and the frames of techniques it has too count as further rounds. Throws Error
/// (kBadInput) naming `origin` where a frame, a count or a machine differs.
void merge_results(BenchResults& into, BenchResults more, const std::string& origin);

/// Takes over another round's times where its time to image is shorter.
void keep_faster(BenchFrame& frame, const BenchFrame& another);

}  // namespace mdk
