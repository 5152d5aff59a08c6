// A page for people: totals on top, then what needs looking at, then every job with a bar for its
// time. Colours follow the reader's light or dark setting.
#include <algorithm>
#include <string_view>

#include "preprocess/batch/summary.h"
#include "preprocess/tool/text.h"

namespace mdk {
namespace {

constexpr std::string_view kStyle = R"(
:root{color-scheme:light dark;--line:#8884;--bar:#4a7fc1;--bad:#c0392b;--good:#2e8b57}
body{font:15px/1.5 system-ui,sans-serif;max-width:70rem;margin:2rem auto;padding:0 1rem}
h1{font-size:1.5rem}h2{font-size:1.1rem;margin-top:2rem}
.totals{display:flex;flex-wrap:wrap;gap:1rem}
.totals div{border:1px solid var(--line);border-radius:.5rem;padding:.5rem 1rem}
.totals b{display:block;font-size:1.4rem}
table{border-collapse:collapse;width:100%}
th,td{text-align:left;padding:.25rem .6rem;border-bottom:1px solid var(--line);vertical-align:top}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}
td.path{font-family:ui-monospace,monospace;font-size:.85rem;overflow-wrap:anywhere}
.bar{display:block;height:.5rem;margin-top:.5rem;background:var(--bar);border-radius:.25rem;min-width:1px}
.bad{color:var(--bad);font-weight:600}.good{color:var(--good)}
)";

std::string escaped(const std::string& text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string total(const std::string& figure, const std::string& name) {
  return "<div><b>" + figure + "</b>" + name + "</div>\n";
}

std::string totals_html(const BatchTotals& totals) {
  const std::size_t bad = totals.jobs - totals.done;
  return "<div class=\"totals\">\n" +
         total(grouped_text(totals.done) + " of " + grouped_text(totals.jobs), "jobs done") +
         total("<span class=\"" + std::string(bad > 0 ? "bad" : "good") + "\">" +
                   grouped_text(bad) + "</span>",
               "not done") +
         total(fixed_text(totals.seconds, 1) + " s", "of work") +
         total(bytes_text(totals.output_bytes), "made") +
         total(bytes_text(totals.peak_memory_bytes), "of memory, the largest job") + "</div>\n";
}

std::string failed_html(const BatchSummary& summary) {
  const std::vector<std::size_t> failed = summary.failed();
  if (failed.empty()) return "";
  std::string html =
      "<h2>Not done</h2>\n<table><tr><th>Status</th><th>Record</th><th>Where</th>"
      "<th>Reason</th></tr>\n";
  for (const std::size_t i : failed) {
    const JobOutcome& outcome = summary.outcomes[i];
    const std::string task =
        outcome.record && !outcome.record->task.empty() ? ", task " + outcome.record->task : "";
    html += "<tr><td class=\"bad\">" + outcome.status() + "</td><td class=\"path\">" +
            escaped(outcome.job->record) + "</td><td>" +
            escaped(outcome.record ? outcome.record->host + task : "") + "</td><td>" +
            escaped(outcome.reason()) + "</td></tr>\n";
  }
  return html + "</table>\n";
}

std::string top_html(const BatchSummary& summary, const std::string& title,
                     const std::vector<std::size_t>& numbers) {
  if (numbers.empty()) return "";
  const double longest =
      std::max(1e-9, summary.outcomes[summary.slowest(1).front()].record->seconds);
  std::string html = "<h2>" + title +
                     "</h2>\n<table><tr><th>Job</th><th>Record</th><th class=\"n\">Time</th>"
                     "<th style=\"width:20%\"></th><th class=\"n\">Memory</th>"
                     "<th class=\"n\">Files</th></tr>\n";
  for (const std::size_t i : numbers) {
    const JobOutcome& outcome = summary.outcomes[i];
    const JobRecord& record = *outcome.record;
    html += std::string("<tr><td>") + kind_name(outcome.job->kind) + "</td><td class=\"path\">" +
            escaped(outcome.job->record) + "</td><td class=\"n\">" + fixed_text(record.seconds, 2) +
            " s</td><td><span class=\"bar\" style=\"width:" +
            fixed_text(100 * record.seconds / longest, 1) + "%\"></span></td><td class=\"n\">" +
            bytes_text(record.peak_memory_bytes) + "</td><td class=\"n\">" +
            bytes_text(outcome.output_bytes()) + "</td></tr>\n";
  }
  return html + "</table>\n";
}

}  // namespace

std::string summary_html(const BatchSummary& summary, const std::string& title) {
  constexpr std::size_t kTop = 10;
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width\">\n<title>" +
         escaped(title) + "</title>\n<style>" + std::string(kStyle) +
         "</style></head>\n<body>\n<h1>" + escaped(title) + "</h1>\n" +
         totals_html(summary.totals) + failed_html(summary) +
         top_html(summary, "Most memory", summary.hungriest(kTop)) +
         top_html(summary, "Largest files", summary.largest(kTop)) +
         top_html(summary, "All that are done, slowest first",
                  summary.slowest(summary.outcomes.size())) +
         "</body></html>\n";
}

}  // namespace mdk
