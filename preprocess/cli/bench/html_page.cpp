#include "preprocess/cli/bench/html_page.h"

namespace mdk {
namespace {

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

std::string cell(std::string_view element, bool left, const std::string& text) {
  std::string html("<");
  html.append(element).append(left ? " class=\"l\">" : ">").append(marked_up(text));
  return html.append("</").append(element).append(">");
}

struct BlockWriter {
  std::string& html;

  void operator()(const Paragraph& paragraph) const {
    html += "<p>" + marked_up(paragraph.text) + "</p>\n";
  }

  void operator()(const Table& table) const {
    html += "<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>";
    for (std::size_t i = 0; i < table.head.size(); ++i)
      html += cell("th", i < table.left_columns, table.head[i]);
    html += "</tr></thead>\n<tbody>\n";
    for (const std::vector<std::string>& row : table.rows) {
      html += "<tr>";
      for (std::size_t i = 0; i < row.size(); ++i)
        html += cell("td", i < table.left_columns, row[i]);
      html += "</tr>\n";
    }
    html += "</tbody></table></div>\n";
  }

  void operator()(const Figure& figure) const {
    html += "<figure><figcaption>" + marked_up(figure.caption) + "</figcaption>\n";
    if (figure.has_legend) {
      html += "<ul class=\"legend\">";
      for (const auto& [label, style] : legend_of(figure))
        html += "<li>" + swatch_svg(style) + escaped(label) + "</li>";
      html += "</ul>\n";
    }
    const bool wide = figure.charts.size() < 3;
    html += wide ? "<div class=\"charts wide\">\n" : "<div class=\"charts\">\n";
    for (const Chart& chart : figure.charts)
      html += chart_svg(chart, wide ? ChartSize{560, 320} : ChartSize{});
    html += "</div></figure>\n";
  }
};

std::string contents(const Report& report) {
  std::string html = "<nav aria-label=\"Contents\"><details open><summary>Contents</summary><ol>\n";
  for (const Section& section : report.sections)
    html += "<li><a href=\"#" + section.id + "\">" + escaped(section.title) + "</a></li>\n";
  return html + "</ol></details></nav>\n";
}

std::string head(const Report& report) {
  std::string html =
      "<header class=\"head\"><h1>" + escaped(report.title) + "</h1>\n<dl class=\"facts\">";
  for (const auto& [name, value] : report.facts)
    html += "<dt>" + escaped(name) + "</dt><dd>" + marked_up(value) + "</dd>\n";
  return html + "</dl></header>\n";
}

}  // namespace

std::string html_page(const Report& report) {
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
      escaped(report.title) + "</title>\n<style>" + std::string(kPageRules) + chart_style(":root") +
      "</style>\n</head>\n<body>\n<div class=\"page\">\n" + head(report) + contents(report) +
      "<main>\n";
  for (const Section& section : report.sections) {
    html += "<section id=\"" + section.id + "\"><h2>" + escaped(section.title) + "</h2>\n";
    for (const Block& block : section.blocks) std::visit(BlockWriter{html}, block);
    html += "</section>\n";
  }
  return html + "</main>\n</div>\n</body>\n</html>\n";
}

}  // namespace mdk
