#include "preprocess/cli/bench/markdown_pages.h"

#include <algorithm>
#include <sstream>

#include "common/base/error.h"
#include "preprocess/cli/bench/sections.h"

namespace mdk {
namespace {

constexpr std::string_view kBegin = "<!-- bench: ", kBeginEnds = " -->\n",
                           kEnd = "<!-- end of bench -->";
constexpr double kLegendRow = 20, kLegendEntry = 200, kGap = 8, kMargin = 12;

std::string row_text(const std::vector<std::string>& cells) {
  std::string line = "|";
  for (const std::string& cell : cells) {
    line += " ";
    for (const char c : cell) line += c == '|' ? std::string("\\|") : std::string(1, c);
    line += " |";
  }
  return line + "\n";
}

std::string table_text(const Table& table) {
  std::string text = row_text(table.head) + "|";
  for (std::size_t i = 0; i < table.head.size(); ++i)
    text += i < table.left_columns ? "---|" : "---:|";
  text += "\n";
  for (const std::vector<std::string>& row : table.rows) text += row_text(row);
  return text;
}

struct BlockWriter {
  const std::string& name;
  std::string& document;
  std::vector<TextFile>& files;

  void operator()(const Paragraph& paragraph) const { document += paragraph.text + "\n\n"; }
  void operator()(const Table& table) const { document += table_text(table) + "\n"; }
  void operator()(const Figure& figure) const {
    const std::string path = name + "/" + figure.id + ".svg";
    document += figure.caption + "\n\n![" + figure.id + "](" + path + ")\n\n";
    files.push_back({path, figure_svg(figure)});
  }
};

std::string setting_text(const BenchResults& results) {
  const BenchRun& run = results.runs.front();
  const std::string threads =
      run.threads == 1 ? "one thread" : std::to_string(run.threads) + " threads";
  return std::to_string(run.width) + "×" + std::to_string(run.height) + ", " + threads + ", " +
         run.isa + ", " + results.machine.cpu + ", commit " + results.program.commit + "\n";
}

std::string quote_text(const std::string& topic, const BenchResults& results,
                       const std::string& origin) {
  std::istringstream words(topic);
  std::string kind;
  words >> kind;
  if (kind == "setting") return setting_text(results);
  if (kind != "techniques")
    throw bad_input(origin, "the marker 'bench: " + topic +
                                "' asks for something else than setting or techniques");
  std::vector<std::string> models;
  for (std::string model; words >> model;) {
    if (results.runs.front().find(model) == nullptr)
      throw bad_input(
          origin, "the marker 'bench: " + topic + "' names " + model + ", which was not measured");
    models.push_back(model);
  }
  return table_text(technique_table_of(results.runs.front(), models));
}

std::string placed(double x, double y, const std::string& svg) {
  return "<g transform=\"translate(" + std::to_string(static_cast<int>(x)) + " " +
         std::to_string(static_cast<int>(y)) + ")\">" + svg + "</g>\n";
}

}  // namespace

std::vector<TextFile> markdown_pages(const Report& report, const std::string& name) {
  std::vector<TextFile> files;
  std::string document = "# " + report.title +
                         "\n\n<!-- Written by docs/make_results.sh; do not "
                         "edit. -->\n\n| | |\n|---|---|\n";
  for (const auto& [fact, value] : report.facts) document += row_text({fact, value});
  document += "\n";
  for (const Section& section : report.sections) {
    document += "## " + section.title + "\n\n";
    for (const Block& block : section.blocks) std::visit(BlockWriter{name, document, files}, block);
  }
  while (document.ends_with("\n\n")) document.pop_back();
  files.insert(files.begin(), {name + ".md", std::move(document)});
  return files;
}

std::string figure_svg(const Figure& figure) {
  const bool wide = figure.charts.size() < 3;
  const ChartSize size = wide ? ChartSize{560, 320} : ChartSize{};
  const std::size_t columns = std::min<std::size_t>(figure.charts.size(), 2);
  const double width = static_cast<double>(columns) * (size.width + kGap) - kGap + 2 * kMargin;
  const auto per_row =
      std::max<std::size_t>(1, static_cast<std::size_t>((width - 2 * kMargin) / kLegendEntry));
  std::string body;
  double y = kMargin;
  if (figure.has_legend) {
    const auto legend = legend_of(figure);
    for (std::size_t i = 0; i < legend.size(); ++i)
      body += placed(kMargin + static_cast<double>(i % per_row) * kLegendEntry,
                     y + static_cast<double>(i / per_row) * kLegendRow,
                     "<path class=\"line " + legend[i].second +
                         "\" d=\"M1 8H27\"/><text x=\"34\" y=\"12\">" + escaped(legend[i].first) +
                         "</text>");
    y += static_cast<double>((legend.size() + per_row - 1) / per_row) * kLegendRow + kGap;
  }
  for (std::size_t i = 0; i < figure.charts.size(); ++i) {
    std::string chart = chart_svg(figure.charts[i], size);
    const std::string natural_size = " width=\"" + std::to_string(static_cast<int>(size.width)) +
                                     "\" height=\"" +
                                     std::to_string(static_cast<int>(size.height)) + "\"";
    chart.insert(std::string("<svg").size(), natural_size);
    body += placed(kMargin + static_cast<double>(i % columns) * (size.width + kGap), y, chart);
    if (i % columns + 1 == columns || i + 1 == figure.charts.size()) y += size.height + kGap;
  }
  const std::string box = std::to_string(static_cast<int>(width)) + " " +
                          std::to_string(static_cast<int>(y + kMargin - kGap));
  return "<svg class=\"chart\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + box +
         "\">\n<style>\n" + chart_style("svg") +
         "</style>\n<rect width=\"100%\" height=\"100%\" fill=\"var(--chart-ground)\"/>\n" + body +
         "</svg>\n";
}

std::string with_quotes(std::string_view text, const BenchResults& results,
                        const std::string& origin) {
  std::string filled;
  for (;;) {
    const std::size_t begin = text.find(kBegin);
    if (begin == std::string_view::npos) return filled.append(text);
    const std::size_t topic_end = text.find(kBeginEnds, begin);
    const std::size_t end =
        topic_end == std::string_view::npos ? topic_end : text.find(kEnd, topic_end);
    if (end == std::string_view::npos)
      throw bad_input(origin, "a marker '" + std::string(kBegin) + "' has no '" +
                                  std::string(kEnd) + "' after it");
    const std::string topic(text.substr(begin + kBegin.size(), topic_end - begin - kBegin.size()));
    filled.append(text.substr(0, topic_end + kBeginEnds.size()));
    filled += quote_text(topic, results, origin);
    filled.append(kEnd);
    text.remove_prefix(end + kEnd.size());
  }
}

}  // namespace mdk
