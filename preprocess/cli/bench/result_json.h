// Bench results as a file: schema "mdprep-bench/1".
#pragma once

#include <string>
#include <string_view>

#include "preprocess/cli/bench/results.h"

namespace mdk {

/// The first run's fields stand at the top, where scripts look for them; other runs are in
/// "further_runs". Medians are there for scripts; everything else follows from the frames.
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
