// A report: what a result file says, as sections of text, tables and figures. It is described once
// (report.cpp; papers.cpp for what stands beside GFW06, thesis.cpp beside Lo09): a table by its
// rows and columns, a figure by the series of its charts. Pages, documents, lines of text and CSV
// are made of the description (pages.cpp).
//
// Texts know one kind of markup: `code` and **strong**.
#pragma once

#include <cstddef>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "preprocess/bench/chart.h"
#include "preprocess/bench/results.h"

namespace mdk {

struct Paragraph {
  std::string text;
};

struct Table {
  std::string text;  ///< before it, or empty
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::size_t left_columns = 1;  ///< aligned to the left; the others are numbers
};

/// What a column says of each row.
template <class Row>
struct Column {
  std::string head;
  std::function<std::string(const Row&)> cell;
};

template <class Row>
Table table_of(std::string text, const std::vector<Row>& rows,
               const std::vector<Column<Row>>& columns, std::size_t left_columns = 1) {
  Table table{std::move(text), {}, {}, left_columns};
  for (const Column<Row>& column : columns) table.head.push_back(column.head);
  for (const Row& row : rows) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    for (const Column<Row>& column : columns) cells.push_back(column.cell(row));
  }
  return table;
}

using Block = std::variant<Paragraph, Table, Figure>;

struct Section {
  std::string id, title;
  std::vector<Block> blocks;
};

/// The table, or where it has no rows what it needs.
Block or_needs(Table table, const char* needs);
/// A section that shows one figure, or where there is no chart says what it needs.
Section figure_section(Figure figure, std::string title, const char* needs);

struct Report {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value: machine, program
  std::vector<Section> sections;
};

Report make_report(const BenchResults& results);

/// Tables and figures of GFW06 and Lo09 with our figures in place of theirs.
std::vector<Section> gfw06_sections(const BenchRun& run);
std::vector<Section> lo09_sections(const BenchRun& run);

/// What the cost of each model expects beside how long its rays took.
Section predicted_cost_section(const BenchRun& run);

/// Every figure of every technique, a table for each model.
Section detail_section(const BenchRun& run);

/// One row for each technique of these models: README's table.
Table technique_table_of(const BenchRun& run, const std::vector<std::string>& models);
/// A row for each model and technique, for people at a terminal.
Table printed_table(const BenchRun& run);
/// A row for each run, model and technique with the names of the JSON.
Table csv_table(const BenchResults& results);

// --- for those who describe sections ---

/// "–" where nothing can be divided by.
std::string ratio_text(double a, double b);
/// The same, to be looked at first.
std::string strong_ratio(double a, double b);

/// Models are baked in other ways, too, to be compared: "paper" (by GFW06's method), "bones" (a
/// cluster for each), "space" (bones, for a pose space), "first" (the first key as rest pose),
/// "level" (one pose, cut into clusters). Which way, by the end of the name ("hand-paper"); empty
/// for the usual one.
std::string variant_of(const std::string& name);
/// The name without that.
std::string base_name(const std::string& name);

/// A chart for each model but those whose triangles are split ("hand-split2") and those baked in
/// another way than usual: charts over time.
/// Those without series are left out.
std::vector<Chart> charts_of_models(const BenchRun& run,
                                    const std::function<Chart(const ModelBench&)>& chart_of);
std::vector<const ModelBench*> whole_models(const BenchRun& run);

/// A line for each technique, but for Embree's single modes where its best is there; without points
/// it is left out.
std::vector<ChartSeries> technique_series(
    const ModelBench& model,
    const std::function<std::vector<ChartPoint>(const TechniqueBench&)>& points_of);

// --- what reports and tables become (pages.cpp) ---

struct TextFile {
  std::string name;
  std::string text;
};

/// One page that needs nothing else: no network, no script; light or dark as the reader's system
/// has it.
std::string html_page(const Report& report);

/// Documents for a repository: `name` with ".md" after it first; then its pictures in the folder
/// `name`. File names are relative to the folder of the document.
std::vector<TextFile> markdown_pages(const Report& report, const std::string& name);

/// `text` with what stands between each pair of markers
///
///     <!-- bench: TOPIC ... -->
///     <!-- end of bench -->
///
/// replaced by what `results` say. Topics: "techniques MODEL...", a table of all techniques on
/// models of the first run; "setting", a sentence on machine and program. Throws Error (kBadInput)
/// naming `origin` for a marker without an end or a topic that is none, or about a model that is
/// not there.
std::string with_quotes(std::string_view text, const BenchResults& results,
                        const std::string& origin);

/// Aligned columns.
void print_table(std::ostream& out, const Table& table);
/// One line a row, quoted where it must be (RFC 4180).
std::string csv_text(const Table& table);

}  // namespace mdk
