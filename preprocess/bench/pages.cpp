// What reports and tables become: a page, documents, lines of text.
#include <ostream>
#include <sstream>

#include "common/base/error.h"
#include "preprocess/bench/report.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

// --- HTML ---

constexpr std::string_view kPageRules = R"(
:root{color-scheme:light dark;--ground:#f6f7f9;--card:#ffffff;--ink:#20262d;--faint:#5a6470;
--edge:#dfe3e8;--head:#eef1f4;--link:#0059b8;--code:#eef1f4}
@media (prefers-color-scheme:dark){:root{--ground:#0e1116;--card:#14181d;--ink:#e3e8ee;
--faint:#9aa5b1;--edge:#2b323a;--head:#1c2229;--link:#6db3ff;--code:#1f262e}}
*{box-sizing:border-box}
html{scroll-behavior:smooth;scroll-padding-top:1rem;-webkit-text-size-adjust:100%}
body{margin:0;background:var(--ground);color:var(--ink);
font:15px/1.55 system-ui,-apple-system,'Segoe UI',Roboto,sans-serif}
.page{max-width:1440px;margin:0 auto;padding:1.5rem;display:grid;gap:1.25rem;
grid-template-columns:minmax(0,1fr)}
header,main,nav{min-width:0}
h1{font-size:1.75rem;line-height:1.2;margin:.2rem 0 1rem;letter-spacing:-.01em}
h2{font-size:1.2rem;line-height:1.3;margin:0 0 .6rem}
p{margin:.5rem 0;max-width:78ch}
a{color:var(--link);text-decoration:none}
a:hover{text-decoration:underline}
code{font:.88em ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;background:var(--code);
padding:.1em .3em;border-radius:4px;overflow-wrap:anywhere}
td code,th code{background:none;padding:0;overflow-wrap:normal}
.facts{display:grid;grid-template-columns:max-content minmax(0,1fr);gap:.15rem 1rem;margin:0}
.facts dt{color:var(--faint)}
.facts dd{margin:0;overflow-wrap:anywhere}
section,nav,.head{background:var(--card);border:1px solid var(--edge);border-radius:10px;
padding:1.1rem 1.3rem;margin:0 0 1.25rem}
nav{font-size:.9rem}
nav ol{margin:.4rem 0 0;padding-left:1.5rem}
nav li{margin:.25rem 0}
nav summary{font-weight:600;cursor:pointer}
.scroll{overflow-x:auto;margin:.8rem 0;border:1px solid var(--edge);border-radius:8px}
table{border-collapse:collapse;width:100%;font-size:.86rem;font-variant-numeric:tabular-nums}
th,td{padding:.34rem .42rem;text-align:right;white-space:nowrap;border-bottom:1px solid var(--edge)}
th{background:var(--head);font-weight:600;white-space:normal;vertical-align:bottom;
line-height:1.25;min-width:3.2rem}
tbody tr:last-child td{border-bottom:0}
tbody tr:hover td{background:var(--head)}
.l{text-align:left}
td:first-child,th:first-child{position:sticky;left:0;background:var(--card);
border-right:1px solid var(--edge)}
th:first-child{background:var(--head);z-index:1}
figure{margin:.8rem 0 0}
figcaption{color:var(--faint);font-size:.9rem;max-width:78ch;margin:0 0 .6rem}
.charts{display:grid;gap:.75rem;grid-template-columns:repeat(auto-fill,minmax(min(100%,23rem),1fr))}
.charts.wide{grid-template-columns:repeat(auto-fill,minmax(min(100%,27rem),1fr))}
.chart{display:block;width:100%;max-width:40rem;height:auto;background:var(--chart-ground);
border:1px solid var(--edge);border-radius:8px}
.legend{display:flex;flex-wrap:wrap;gap:.2rem 1.1rem;list-style:none;margin:0 0 .7rem;padding:0;
font-size:.86rem}
.legend li{display:flex;align-items:center;gap:.45rem;white-space:nowrap}
@media (min-width:1100px){
.page{grid-template-columns:13.5rem minmax(0,1fr)}
.head{grid-column:1/-1;margin-bottom:0}
nav{position:sticky;top:1.25rem;align-self:start;max-height:calc(100vh - 2.5rem);overflow:auto}
}
@media (max-width:640px){.page{padding:.75rem;gap:.9rem}section,nav,.head{padding:.9rem}
h1{font-size:1.4rem}.facts{grid-template-columns:1fr}.facts dd{margin-bottom:.35rem}}
@media print{nav{display:none}.page{display:block}section{break-inside:avoid-page}}
)";

/// `code` and **strong** to HTML.
std::string marked_up(std::string_view text) {
  const std::string safe = escaped(text);
  std::string html;
  bool in_code = false, in_strong = false;
  for (std::size_t i = 0; i < safe.size(); ++i) {
    if (safe[i] == '`') {
      html += in_code ? "</code>" : "<code>";
      in_code = !in_code;
    } else if (!in_code && safe.compare(i, 2, "**") == 0) {
      html += in_strong ? "</strong>" : "<strong>";
      in_strong = !in_strong;
      ++i;
    } else {
      html += safe[i];
    }
  }
  return html + (in_strong ? "</strong>" : "") + (in_code ? "</code>" : "");
}

std::string paragraph_html(const std::string& text) { return "<p>" + marked_up(text) + "</p>\n"; }

/// `element`: th or td.
std::string row_html(const std::string& element, const std::vector<std::string>& cells,
                     std::size_t left_columns) {
  std::string html = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i)
    html += "<" + element + (i < left_columns ? " class=\"l\">" : ">") + marked_up(cells[i]) +
            "</" + element + ">";
  return html + "</tr>";
}

struct HtmlWriter {
  std::string& html;

  void operator()(const Paragraph& paragraph) const { html += paragraph_html(paragraph.text); }

  void operator()(const Table& table) const {
    if (!table.text.empty()) html += paragraph_html(table.text);
    html += "<div class=\"scroll\" tabindex=\"0\"><table>\n<thead>" +
            row_html("th", table.head, table.left_columns) + "</thead>\n<tbody>\n";
    for (const std::vector<std::string>& row : table.rows)
      html += row_html("td", row, table.left_columns) + "\n";
    html += "</tbody></table></div>\n";
  }

  void operator()(const Figure& figure) const {
    html += "<figure><figcaption>" + marked_up(figure.caption) + "</figcaption>\n";
    if (figure.has_legend) {
      html += "<ul class=\"legend\">";
      for (const auto& [label, style] : figure.legend())
        html += "<li>" + swatch_svg(style) + escaped(label) + "</li>";
      html += "</ul>\n";
    }
    html += figure.is_wide() ? "<div class=\"charts wide\">\n" : "<div class=\"charts\">\n";
    for (const Chart& chart : figure.charts) html += chart_svg(chart, figure.chart_size());
    html += "</div></figure>\n";
  }
};

// --- Markdown ---

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

struct MarkdownWriter {
  const std::string& name;
  std::string& document;
  std::vector<TextFile>& files;

  void operator()(const Paragraph& paragraph) const { document += paragraph.text + "\n\n"; }
  void operator()(const Table& table) const {
    if (!table.text.empty()) document += table.text + "\n\n";
    document += table_text(table) + "\n";
  }
  void operator()(const Figure& figure) const {
    const std::string path = name + "/" + figure.id + ".svg";
    document += figure.caption + "\n\n![" + figure.id + "](" + path + ")\n\n";
    files.push_back({path, figure_svg(figure)});
  }
};

// --- quotes ---

constexpr std::string_view kBegin = "<!-- bench: ", kBeginEnds = " -->\n",
                           kEnd = "<!-- end of bench -->";

std::string setting_text(const BenchResults& results) {
  const BenchSetting& run = results.runs.front().setting;
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

/// Quoted where it must be (RFC 4180).
std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) line.append(line.empty() ? "" : ",").append(csv_cell(cell));
  return line + "\n";
}

}  // namespace

std::string html_page(const Report& report) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
      escaped(report.title) + "</title>\n<style>" + std::string(kPageRules) + chart_style(":root") +
      "</style>\n</head>\n<body>\n<div class=\"page\">\n<header class=\"head\"><h1>" +
      escaped(report.title) + "</h1>\n<dl class=\"facts\">";
  for (const auto& [name, value] : report.facts)
    html += "<dt>" + escaped(name) + "</dt><dd>" + marked_up(value) + "</dd>\n";
  html +=
      "</dl></header>\n<nav aria-label=\"Contents\"><details "
      "open><summary>Contents</summary><ol>\n";
  for (const Section& section : report.sections)
    html += "<li><a href=\"#" + section.id + "\">" + escaped(section.title) + "</a></li>\n";
  html += "</ol></details></nav>\n<main>\n";
  for (const Section& section : report.sections) {
    html += "<section id=\"" + section.id + "\"><h2>" + escaped(section.title) + "</h2>\n";
    for (const Block& block : section.blocks) std::visit(HtmlWriter{html}, block);
    html += "</section>\n";
  }
  return html + "</main>\n</div>\n</body>\n</html>\n";
}

std::vector<TextFile> markdown_pages(const Report& report, const std::string& name) {
  std::vector<TextFile> files(1);
  std::string document = "# " + report.title +
                         "\n\n<!-- Written by docs/make_results.sh; do not "
                         "edit. -->\n\n| | |\n|---|---|\n";
  for (const auto& [fact, value] : report.facts) document += row_text({fact, value});
  document += "\n";
  for (const Section& section : report.sections) {
    document += "## " + section.title + "\n\n";
    for (const Block& block : section.blocks)
      std::visit(MarkdownWriter{name, document, files}, block);
  }
  while (document.ends_with("\n\n")) document.pop_back();
  files.front() = {name + ".md", std::move(document)};
  return files;
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

void print_table(std::ostream& out, const Table& table) {
  TextTable text(table.left_columns);
  text.add_row(table.head);
  for (const std::vector<std::string>& row : table.rows) text.add_row(row);
  text.print(out);
}

std::string csv_text(const Table& table) {
  std::string text = csv_line(table.head);
  for (const std::vector<std::string>& row : table.rows) text += csv_line(row);
  return text;
}

}  // namespace mdk
