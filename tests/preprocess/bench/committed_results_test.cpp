// The figures in README.md and docs/ are those of the committed result file, and nobody edited
// them: they are made anew here and compared.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "preprocess/bench/report.h"
#include "preprocess/bench/results.h"
#include "tests/formats/temp_folder.h"

namespace mdk::test {
namespace {

const std::string kRoot = MDK_SOURCE_DIR;
constexpr const char* kAgain = "run 'docs/make_results.sh write' and commit what it wrote";

BenchResults committed() { return read_results(kRoot + "/docs/results/benchmark.json"); }

TEST(CommittedResults, TheDocumentAndItsPicturesAreMadeFromTheResultFile) {
  for (const TextFile& file : markdown_pages(make_report(committed()), "benchmark"))
    EXPECT_TRUE(read_text(kRoot + "/docs/results/" + file.name) == file.text)
        << file.name << ": " << kAgain;
}

TEST(CommittedResults, EveryDocumentQuotesTheResultFile) {
  std::vector<std::string> documents = {kRoot + "/README.md"};
  for (const auto& entry : std::filesystem::directory_iterator(kRoot + "/docs"))
    if (entry.path().extension() == ".md") documents.push_back(entry.path().string());
  const BenchResults results = committed();
  std::size_t quoting = 0;
  for (const std::string& document : documents) {
    const std::string text = read_text(document);
    EXPECT_TRUE(with_quotes(text, results, document) == text) << document << ": " << kAgain;
    quoting += text.find("<!-- bench: ") != std::string::npos;
  }
  EXPECT_GE(quoting, 1u) << "README.md has figures";
}

TEST(CommittedResults, NoTechniqueOfOursDiffersFromBruteForce) {
  for (const BenchRun& run : committed().runs)
    for (const ModelBench& model : run.models)
      for (const TechniqueBench& technique : model.techniques)
        if (technique.id.rfind("embree", 0) != 0) {
          EXPECT_EQ(technique.hit_mismatches, 0u)
              << model.name() << " " << technique.id << " " << run.setting.isa;
        }
}

}  // namespace
}  // namespace mdk::test
