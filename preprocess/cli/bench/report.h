// A report: what a result file says, as sections of text, tables and charts, before anyone decides
// whether it becomes a page (html_page.h) or documents (markdown_pages.h).
//
// Texts know one kind of markup: `code` and **strong**.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "preprocess/cli/bench/chart.h"
#include "preprocess/cli/bench/results.h"

namespace mdk {

struct Paragraph {
  std::string text;
};

struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;
  std::size_t left_columns = 1;  ///< aligned to the left; the others are numbers
};

/// Charts that share a legend, where they have one.
struct Figure {
  std::string id;  ///< for file names and links
  std::string caption;
  std::vector<Chart> charts;
  bool has_legend = true;
};

using Block = std::variant<Paragraph, Table, Figure>;

struct Section {
  std::string id, title;
  std::vector<Block> blocks;
};

struct Report {
  std::string title;
  std::vector<std::pair<std::string, std::string>> facts;  ///< name and value: machine, program
  std::vector<Section> sections;
};

Report make_report(const BenchResults& results);

/// The label and style of every series of a figure, once each, in order of appearance.
std::vector<std::pair<std::string, std::string>> legend_of(const Figure& figure);

}  // namespace mdk
