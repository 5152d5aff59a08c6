#include "preprocess/cli/bench/outputs.h"

#include <filesystem>

#include "common/base/error.h"
#include "preprocess/cli/bench/html_page.h"
#include "preprocess/cli/bench/markdown_pages.h"
#include "preprocess/cli/bench/result_json.h"
#include "preprocess/cli/bench/result_tables.h"
#include "preprocess/cli/output_paths.h"
#include "preprocess/cli/text_file.h"

namespace mdk {
namespace {

constexpr std::size_t kLargestDocument = std::size_t{16} << 20;

void make_folder(const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directory(folder, problem);
  if (problem) throw io_error(folder.string(), "cannot be made: " + problem.message());
}

/// The document and its pictures, as files.
std::vector<TextFile> document_files(const std::string& path, const Report& report) {
  const std::filesystem::path document(path);
  std::vector<TextFile> files = markdown_pages(report, document.stem().string());
  for (TextFile& file : files) file.name = (document.parent_path() / file.name).string();
  files.front().name = path;
  return files;
}

}  // namespace

void check_outputs(const BenchOutputs& outputs, const std::vector<std::string>& inputs) {
  const std::string files[] = {outputs.json, outputs.csv, outputs.html, outputs.markdown};
  require_distinct_files("", files);
  for (const std::string& input : inputs) require_distinct_files(input, files);
  for (const std::string& file : files)
    if (!file.empty()) require_writable_place(file);
  if (!outputs.markdown.empty() &&
      std::filesystem::path(outputs.markdown).extension().string() != ".md")
    throw Error(ErrorCode::kUsage,
                "--markdown " + outputs.markdown +
                    ": the name must end in .md; pictures go into the folder of that name");
}

void write_outputs(const BenchOutputs& outputs, const BenchResults& results) {
  std::vector<TextFile> files;
  if (!outputs.json.empty()) files.push_back({outputs.json, results_json(results)});
  if (!outputs.csv.empty()) files.push_back({outputs.csv, results_csv(results)});
  if (!outputs.html.empty()) files.push_back({outputs.html, html_page(make_report(results))});
  if (!outputs.markdown.empty())
    for (TextFile& file : document_files(outputs.markdown, make_report(results)))
      files.push_back(std::move(file));
  for (const std::string& document : outputs.quoting)
    files.push_back(
        {document, with_quotes(read_text_file(document, kLargestDocument), results, document)});

  if (!outputs.markdown.empty())
    make_folder(std::filesystem::path(outputs.markdown).replace_extension());
  for (const TextFile& file : files) write_text_file(file.name, file.text);
}

}  // namespace mdk
