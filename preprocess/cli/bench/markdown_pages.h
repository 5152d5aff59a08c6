// A report as documents for a repository: one Markdown file and the pictures it shows; and the
// texts between markers by which other documents quote it.
#pragma once

#include <string>
#include <vector>

#include "preprocess/cli/bench/report.h"
#include "preprocess/cli/bench/results.h"

namespace mdk {

struct TextFile {
  std::string name;  ///< relative to the folder of the document
  std::string text;
};

/// The document, `name` with ".md" after it, first; then its pictures in the folder `name`.
std::vector<TextFile> markdown_pages(const Report& report, const std::string& name);

/// A picture of its own: a figure's legend and charts, in light or dark colours.
std::string figure_svg(const Figure& figure);

/// `text` with what stands between each pair of markers
///
///     <!-- bench: TOPIC ... -->
///     <!-- end of bench -->
///
/// made anew from `results`. Topics: "techniques MODEL...", a table of all techniques on models of
/// the first run; "setting", a sentence on machine and program. Throws Error (kBadInput) naming
/// `origin` for a marker without an end or a topic that is none, or about a model that is not
/// there.
std::string with_quotes(std::string_view text, const BenchResults& results,
                        const std::string& origin);

}  // namespace mdk
