#include "preprocess/batch/plan.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "common/base/error.h"
#include "preprocess/batch/path_pattern.h"
#include "preprocess/tool/files.h"
#include "preprocess/tool/shared_options.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t kMaxFrames = 10'000'000;

/// "-x.glb" would be an option.
std::string file_word(const std::string& path) {
  const std::string plain = plain_path(path);
  return plain.starts_with('-') ? "./" + plain : plain;
}

/// A name for records, below their folder whatever the path.
std::string record_name(const std::string& path) {
  std::string name;
  for (const fs::path& part : fs::path(path).relative_path()) {
    if (!name.empty()) name += '/';
    name += part == ".." ? std::string("up") : part.string();
  }
  return name;
}

std::string folder_of(const std::string& path) {
  const std::string folder = fs::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

class Planner {
 public:
  Planner(const Manifest& manifest, const CommandCheck& check)
      : manifest_(manifest), check_(check) {}

  std::vector<Job> plan() {
    for (const ManifestItem& item : manifest_.items) plan_item(item);
    return std::move(jobs_);
  }

 private:
  /// A file that an item's input names.
  struct Match {
    std::string path, pattern;
  };

  /// Returns work(); what it throws is told with its place in the manifest.
  template <class Work>
  auto at(const ManifestItem& item, const std::string& field, Work work) const {
    try {
      return work();
    } catch (const Error& error) {
      refuse_place(manifest_, item.place + field, error.what());
    }
  }

  std::vector<std::string> candidates(const ManifestItem& item, const std::string& pattern) const {
    if (item.kind == JobKind::kBake || !is_pattern(pattern))
      return files_matching(manifest_.folder, pattern);
    std::vector<std::string> baked;
    for (const auto& [path, job] : maker_)
      if (jobs_[job].kind == JobKind::kBake && matches_pattern(plain_path(pattern), path))
        baked.push_back(path);
    return baked.empty() ? files_matching(manifest_.folder, pattern) : baked;
  }

  std::vector<Match> matches(const ManifestItem& item) const {
    const std::string& pattern = item.inputs.front();
    std::vector<Match> found;
    for (const std::string& path : candidates(item, pattern)) {
      const auto excludes = [&](const std::string& p) {
        return matches_pattern(plain_path(p), plain_path(path));
      };
      if (std::none_of(item.exclude.begin(), item.exclude.end(), excludes))
        found.push_back({path, pattern});
    }
    if (found.empty())
      refuse_place(manifest_, item.place + "/input",
                   "\"" + pattern + "\" names no file in " + manifest_.folder + "; correct it");
    return found;
  }

  std::string filled(const ManifestItem& item, const std::string& name, const Match& match,
                     const std::string& field) const {
    return at(item, field, [&] { return file_word(fill_name(name, match.path, match.pattern)); });
  }

  Job start_job(const ManifestItem& item, const Match& match) const {
    Job job;
    job.kind = item.kind;
    job.place = item.place;
    job.threads = item.threads;
    job.memory_bytes = item.memory_bytes;
    job.minutes = item.minutes;
    job.command = {kind_name(item.kind)};
    job.inputs = {file_word(match.path)};
    for (std::size_t i = 1; i < item.inputs.size(); ++i)
      job.inputs.push_back(filled(item, item.inputs[i], match, "/input/" + std::to_string(i)));
    job.command.insert(job.command.end(), job.inputs.begin(), job.inputs.end());
    for (std::string& input : job.inputs)
      if (has_number_place(input)) input = folder_of(input);  // where new frames would appear
    if (const auto made = maker_.find(job.inputs.front()); made != maker_.end())
      job.needs.push_back(made->second);
    return job;
  }

  void finish_job(const ManifestItem& item, Job job, const std::string& name) {
    job.command.insert(job.command.end(), item.options.begin(), item.options.end());
    job.record = plain_path(manifest_.records + "/" + record_name(name) + ".json");
    for (const std::string& made : job.outputs) claim(item, made);
    claim(item, job.record);
    jobs_.push_back(std::move(job));
  }

  /// Notes that the next job makes `path`.
  void claim(const ManifestItem& item, const std::string& path) {
    const auto [other, is_new] = maker_.emplace(path, jobs_.size());
    if (is_new) return;
    const std::string also = other->second < jobs_.size() ? jobs_[other->second].place : item.place;
    refuse_place(manifest_, item.place,
                 path + " is made by " + also + ", too; give each an output of its own");
  }

  void plan_bake(const ManifestItem& item, const Match& match) {
    Job job = start_job(item, match);
    const std::string output = filled(item, item.output, match, "/output");
    if (std::ranges::count(job.inputs, output) > 0)
      refuse_place(manifest_, item.place + "/output",
                   output + " is the input; give the output a name of its own");
    job.command.insert(job.command.end(), {"-o", output});
    job.outputs = {output};
    finish_job(item, std::move(job), output);
    options_of_bake_[output] = item.options;
  }

  void plan_verify(const ManifestItem& item, const Match& match) {
    if (item.inputs.size() > 1)
      refuse_place(manifest_, item.place + "/input", "a verify takes one file");
    Job job = start_job(item, match);
    if (item.with_source) {
      if (job.needs.empty())
        refuse_place(manifest_, item.place + "/source",
                     "nothing in this manifest bakes " + match.path +
                         ", so its source is not known; leave \"source\" out");
      const Job& bake = jobs_[job.needs.front()];
      for (std::size_t i = 1; bake.command[i] != "-o"; ++i)  // its inputs come first
        job.command.push_back("--source=" + bake.command[i]);
      job.inputs.insert(job.inputs.end(), bake.inputs.begin(), bake.inputs.end());
      for (const std::string& word : options_of_bake_[job.inputs.front()])
        if (word.starts_with("--fps=") || word.starts_with("--clips=")) job.command.push_back(word);
    }
    const std::string name = job.inputs.front() + ".verify";
    finish_job(item, std::move(job), name);
  }

  void plan_render(const ManifestItem& item, const Match& match) {
    if (item.inputs.size() > 1)
      refuse_place(manifest_, item.place + "/input", "a render takes one file");
    const std::string output = filled(item, item.output, match, "/output");
    Job job = start_job(item, match);
    job.command.insert(job.command.end(), {"-o", output});
    if (!item.frames.empty() && has_number_place(output)) return plan_ranges(item, job, output);
    if (!item.frames.empty()) job.command.push_back("--frames=" + item.frames);
    if (!has_number_place(output)) job.outputs = {output};
    finish_job(item, std::move(job), numbered_path(output, "all"));
  }

  void plan_ranges(const ManifestItem& item, const Job& whole, const std::string& output) {
    const std::vector<std::uint32_t> keys = at(item, "/frames", [&] {
      return with_name(item.frames, [&] { return parse_key_range(item.frames).keys(kMaxFrames); });
    });
    const std::size_t run = item.frames_per_job == 0 ? keys.size() : item.frames_per_job;
    const std::uint32_t step = keys.size() > 1 ? keys[1] - keys[0] : 1;
    for (std::size_t first = 0; first < keys.size(); first += run) {
      const std::size_t end = std::min(keys.size(), first + run);
      const std::string a = std::to_string(keys[first]), b = std::to_string(keys[end - 1]);
      Job job = whole;
      std::string& range = job.command.emplace_back("--frames=").append(a).append(":").append(b);
      if (step != 1) range.append(":").append(std::to_string(step));
      for (std::size_t i = first; i < end; ++i)
        job.outputs.push_back(numbered_path(output, keys[i]));
      finish_job(item, std::move(job), numbered_path(output, a + "-" + b));
    }
  }

  void plan_item(const ManifestItem& item) {
    const std::size_t before = jobs_.size();
    for (const Match& match : matches(item)) {
      switch (item.kind) {
        case JobKind::kBake:
          plan_bake(item, match);
          break;
        case JobKind::kVerify:
          plan_verify(item, match);
          break;
        case JobKind::kRender:
          plan_render(item, match);
          break;
      }
    }
    // The command itself says what is wrong with its options; once for all files of an item.
    at(item, "/options", [&] { check_(jobs_[before].command); });
  }

  const Manifest& manifest_;
  const CommandCheck& check_;
  std::vector<Job> jobs_;
  std::map<std::string, std::size_t> maker_;  ///< which job makes a file
  std::map<std::string, std::vector<std::string>> options_of_bake_;
};

}  // namespace

std::vector<Job> plan_jobs(const Manifest& manifest, const CommandCheck& check) {
  return Planner(manifest, check).plan();
}

}  // namespace mdk
