// The report as data, as a page and as documents, from results that were made up.
#include "preprocess/bench/report.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "tests/formats/expect_error.h"
#include "tests/preprocess/bench/made_up_results.h"

namespace mdk::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

Section section(const Report& report, const std::string& id) {
  const auto found = std::find_if(report.sections.begin(), report.sections.end(),
                                  [&](const Section& s) { return s.id == id; });
  if (found == report.sections.end()) throw std::runtime_error("there is no section " + id);
  return *found;
}

template <class Kind>
Kind block(const Section& section) {
  for (const Block& block : section.blocks)
    if (std::holds_alternative<Kind>(block)) return std::get<Kind>(block);
  throw std::runtime_error("no such block in " + section.id);
}

TEST(Report, HasEveryTableAndFigureOfBothPapersAndOurOwn) {
  const Report report = make_report(made_up_results());
  std::vector<std::string> ids;
  for (const Section& s : report.sections) ids.push_back(s.id);
  EXPECT_THAT(ids, ElementsAre("summary", "gfw06-table-1", "gfw06-second-level", "gfw06-figure-7",
                               "gfw06-figure-8", "lo09-table-1", "lo09-table-4-2", "lo09-table-4-4",
                               "lo09-time-to-image", "lo09-trace", "lo09-triangle-tests",
                               "lo09-node-tests", "lo09-update", "predicted-cost", "crossover",
                               "memory", "bake", "machines", "details", "method"));
  for (const char* id :
       {"gfw06-figure-7", "gfw06-figure-8", "lo09-time-to-image", "lo09-trace",
        "lo09-triangle-tests", "lo09-node-tests", "lo09-update", "crossover", "memory"}) {
    const Figure figure = block<Figure>(section(report, id));
    ASSERT_FALSE(figure.charts.empty()) << id;
    for (const Chart& chart : figure.charts) {
      EXPECT_FALSE(chart.x_label.empty()) << id;
      EXPECT_FALSE(chart.y_label.empty()) << id;
      EXPECT_FALSE(chart.series.empty()) << id;
    }
  }
}

TEST(Report, PutsThePapersRatiosBesideOurs) {
  const Table table = block<Table>(section(make_report(made_up_results()), "gfw06-table-1"));
  ASSERT_EQ(table.rows.size(), 1u) << "only one model has both kd-trees";
  EXPECT_THAT(table.rows[0],
              ElementsAre("hand", "16,000", "11", "4", "3.000", "3.000", "**1.00**", "1.76",
                          "0.400", "0.400", "**1.00**", "1.15", "2.00", "2.00", "**1.00**", "24.00",
                          "30.00", "**1.25**", "31.4", "25.2", "**1.25**", "1.64"));
  EXPECT_THAT(table.text, HasSubstr("a triangle test at 0.25 of a traversal step"));
}

TEST(Report, ShowsThePapersOwnTable) {
  const Section table1 = section(make_report(made_up_results()), "gfw06-table-1");
  const Table paper = std::get<Table>(table1.blocks.back());
  ASSERT_EQ(paper.rows.size(), 5u);
  EXPECT_THAT(paper.rows[2], ElementsAre("cow", "5,804", "204", "20", "634,173", "946,558", "1.49",
                                         "0.92", "3.68", "4.0", "19.21", "12.49", "1.53"));
}

/// The made-up hand, baked in each of the other ways.
BenchResults with_variants() {
  BenchResults results = made_up_results();
  BenchRun& run = results.runs[0];
  const ModelBench hand = run.models[0];
  double factor = 2;
  for (const char* variant : {"paper", "bones", "space", "first", "level"}) {
    ModelBench model = hand;
    model.file = std::string("out/hand-") + variant + ".mdk";
    model.predicted_cost = 3 * factor;
    model.techniques.clear();
    for (const char* id :
         {"fuzzy-bvh", "fuzzy-kdtree", "static-kdtree", "rebuild-bvh", "refit-bvh", "decomp-refit"})
      model.techniques.push_back(made_up_technique(id, factor));
    run.models.push_back(std::move(model));
    factor += 1;
  }
  return results;
}

TEST(Report, ComparesWhatWasBakedInOtherWays) {
  BenchResults results = with_variants();
  for (BenchFrame& frame :
       results.runs[0].models[5].techniques[4].frames) {  // hand-first, refitted
    frame.counters.node_visits = 600;
    frame.counters.triangle_tests = 250;
  }
  const Report report = make_report(results);
  const auto table = [&](const char* id) { return block<Table>(section(report, id)); };
  EXPECT_EQ(table("summary").rows.size(), 2u) << "the usual bakes: hand and hand-split1";
  ASSERT_EQ(table("gfw06-table-1").rows.size(), 5u) << "hand and its variants but the single pose";
  EXPECT_EQ(table("gfw06-table-1").rows[1][0], "hand-paper");
  EXPECT_EQ(table("gfw06-table-1").rows[1][7], "1.76") << "the paper's HAND";
  const Table level = table("gfw06-second-level");
  ASSERT_EQ(level.rows.size(), 1u);
  EXPECT_EQ(level.rows[0][0], "hand-level");
  const Table four = std::get<Table>(section(report, "lo09-table-1").blocks[1]);
  ASSERT_EQ(four.rows.size(), 2u);
  EXPECT_EQ(four.rows[1][0], "hand-bones");
  // Made-up: 300 visits and 200 tests a frame, 50 hits.
  EXPECT_THAT(table("lo09-table-4-2").rows,
              ElementsAre(ElementsAre("hand", "12.000", "5.000", "6.000", "4.000", "**0.50**",
                                      "**0.80**")));
  // 26.5 ms times 3 for bones and times 4 for the pose space.
  EXPECT_THAT(table("lo09-table-4-4").rows,
              ElementsAre(ElementsAre("hand", "9.43", "12.58", "**1.33**")));
  const Figure growth = block<Figure>(section(report, "gfw06-figure-7"));
  ASSERT_EQ(growth.charts.size(), 2u);
  EXPECT_EQ(growth.charts[1].title, "hand-paper");
  const Figure predicted = block<Figure>(section(report, "predicted-cost"));
  ASSERT_EQ(predicted.charts.size(), 1u);
  EXPECT_EQ(predicted.charts[0].series.size(), 5u) << "those whose prediction is known";
  EXPECT_THAT(predicted.caption, HasSubstr("over these models: 1.00"));
  // 2 times 20 ms over 50 hits.
  EXPECT_DOUBLE_EQ(predicted.charts[0].series[0].points[0].y, 8e5);
  EXPECT_EQ(block<Figure>(section(report, "lo09-trace")).charts.size(), 1u) << "no variants";
}

TEST(RankCorrelation, IsSpearmans) {
  EXPECT_DOUBLE_EQ(rank_correlation({1, 2, 3, 4}, {10, 20, 25, 1000}), 1);
  EXPECT_DOUBLE_EQ(rank_correlation({1, 2, 3, 4}, {4, 3, 2, 1}), -1);
  EXPECT_DOUBLE_EQ(rank_correlation({1, 2, 3}, {5, 5, 5}), 0);
  // IQ and hours of television, the textbook's example: -29 / 165.
  EXPECT_NEAR(rank_correlation({106, 100, 86, 101, 99, 103, 97, 113, 112, 110},
                               {7, 27, 2, 50, 28, 29, 20, 12, 6, 17}),
              -29.0 / 165, 1e-12);
}

TEST(Report, SaysWhereKdTreesWereNotBuiltAlikeAndWhatWasNotCounted) {
  BenchResults results = made_up_results();
  ModelBench& hand = results.runs[0].models[0];
  hand.file = "out/real-cow.mdk";
  const auto table_1 = [&] { return block<Table>(section(make_report(results), "gfw06-table-1")); };
  hand.techniques[2].kd_cost_ratio = 1.5;
  EXPECT_THAT(table_1().text, HasSubstr("not all trees were built with the same constants"));
  for (TechniqueBench& technique : hand.techniques) {
    technique.kd_cost_ratio = 0;
    for (BenchFrame& frame : technique.frames) frame.counters.leaf_triangles = 0;
  }
  EXPECT_THAT(table_1().text, HasSubstr("of an older program"));
  const std::vector<std::string> row = table_1().rows[0];
  EXPECT_EQ(row[7], "1.49") << "the paper's COW";
  EXPECT_THAT(std::vector(row.begin() + 8, row.begin() + 12), ElementsAre("–", "–", "–", "4.0"));
  const Section details = section(make_report(results), "details");
  EXPECT_THAT(block<Table>(details).rows[0], testing::Contains("–"));
}

TEST(Report, SaysWhereFuzzyStructuresOvertake) {
  const Paragraph text = block<Paragraph>(section(make_report(made_up_results()), "crossover"));
  EXPECT_THAT(text.text, HasSubstr("hand: `fuzzy-bvh` overtakes `refit-bvh` at about 21,000"));
  EXPECT_THAT(text.text, HasSubstr("is faster than `rebuild-bvh` at every size measured."));
}

TEST(Report, ComparesThreadsAndInstructionSets) {
  const Section machines = section(make_report(made_up_results()), "machines");
  const Table runs = block<Table>(machines);
  ASSERT_EQ(runs.rows.size(), 3u);
  EXPECT_EQ(runs.rows[0].back(), "**2.50**");
  EXPECT_EQ(runs.rows[1].back(), "**3.00**");
  const Table threads = std::get<Table>(machines.blocks.back());
  EXPECT_THAT(threads.rows[0],
              ElementsAre("hand", "`fuzzy-bvh`", "avx2", "2", "26.50", "13.25", "**2.00**"));
}

TEST(Report, AModelWithoutBakeReportOrManyKeysStillMakesAReport) {
  BenchResults results = made_up_results();
  results.runs.resize(1);
  results.runs[0].models.resize(1);
  ModelBench& model = results.runs[0].models[0];
  model.bake.reset();
  model.keys = 1;
  model.techniques = {made_up_technique("brute-force")};
  model.techniques[0].frames.resize(1);
  const Report report = make_report(results);
  for (const char* id :
       {"gfw06-table-1", "gfw06-second-level", "gfw06-figure-7", "gfw06-figure-8", "lo09-table-4-2",
        "lo09-table-4-4", "lo09-trace", "predicted-cost", "crossover", "bake"})
    EXPECT_FALSE(block<Paragraph>(section(report, id)).text.empty()) << "says what is missing";
  EXPECT_THAT(html_page(report), HasSubstr("</html>"));
}

TEST(HtmlPage, NeedsNothingElse) {
  std::string page = html_page(make_report(made_up_results()));
  for (const char* word : {"<script", "<link", "src=", "url(", "@import", "<iframe", "<img"})
    EXPECT_THAT(page, Not(HasSubstr(word)));
  const std::string name_space = "http://www.w3.org/2000/svg";
  for (std::size_t at; (at = page.find(name_space)) != std::string::npos;)
    page.erase(at, name_space.size());
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, HasSubstr("prefers-color-scheme:dark"));
}

TEST(HtmlPage, ListsItsContentsAndNamesMachineProgramAndCommand) {
  const Report report = make_report(made_up_results());
  const std::string page = html_page(report);
  for (const Section& s : report.sections) {
    EXPECT_THAT(page, HasSubstr("<a href=\"#" + s.id + "\">"));
    EXPECT_THAT(page, HasSubstr("<section id=\"" + s.id + "\">"));
  }
  EXPECT_THAT(page, HasSubstr("Processor &lt;1&gt; &amp; co, 2 cores"));
  EXPECT_THAT(page, HasSubstr("commit abc1234"));
  EXPECT_THAT(page, HasSubstr("<code>./run bench</code>"));
  EXPECT_THAT(page, Not(HasSubstr("**")));
  EXPECT_THAT(page, Not(HasSubstr("`")));
}

TEST(MarkdownPages, AreOneDocumentAndThePicturesItShows) {
  const std::vector<TextFile> files = markdown_pages(make_report(made_up_results()), "bench");
  ASSERT_EQ(files.size(), 10u);
  EXPECT_EQ(files[0].name, "bench.md");
  for (std::size_t i = 1; i < files.size(); ++i) {
    EXPECT_THAT(files[0].text, HasSubstr("](" + files[i].name + ")"));
    EXPECT_EQ(files[i].text.rfind("<svg class=\"chart\" xmlns=", 0), 0u);
    EXPECT_THAT(files[i].text, HasSubstr("prefers-color-scheme:dark"));
  }
}

TEST(TechniqueTables, CsvHasALinePerRunModelAndTechniqueAndQuotesWhatItMust) {
  BenchResults results = made_up_results();
  results.runs[0].models[0].file = "a,\"b\".mdk";
  std::istringstream csv(csv_text(csv_table(results)));
  std::string header, row;
  std::getline(csv, header);
  std::getline(csv, row);
  EXPECT_EQ(header.rfind("file,isa,threads,width,height,triangles,keys,clusters,id,", 0), 0u);
  EXPECT_EQ(row.rfind("\"a,\"\"b\"\".mdk\",avx2,1,10,10,16000,11,4,fuzzy-bvh,0.5,2,20,4,", 0), 0u);
  int more = 0;
  while (std::getline(csv, row)) ++more;
  EXPECT_EQ(more, 6 + 3 + 2);
}

TEST(TechniqueTables, TheTableHasARowPerTechnique) {
  std::ostringstream out;
  print_table(out, printed_table(made_up_results().runs[0]));
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 7 + 3);
  EXPECT_NE(text.find("26.50"), std::string::npos);
}

TEST(Quotes, AreMadeAnewBetweenTheirMarkersAlone) {
  const std::string document =
      "before\n<!-- bench: techniques hand -->\nold\n<!-- end of bench -->\nbetween\n"
      "<!-- bench: setting -->\n<!-- end of bench -->\nafter\n";
  const std::string quoted = with_quotes(document, made_up_results(), "README.md");
  EXPECT_EQ(quoted.rfind("before\n<!-- bench: techniques hand -->\n| technique |", 0), 0u);
  EXPECT_THAT(quoted, HasSubstr("| `fuzzy-bvh` | 2.00 | 20.0 | 26.5 | 2.0 KiB |\n"));
  EXPECT_THAT(quoted, HasSubstr("10×10, one thread, avx2, Processor <1> & co, commit abc1234\n"));
  EXPECT_THAT(quoted, Not(HasSubstr("old")));
  EXPECT_EQ(with_quotes(quoted, made_up_results(), "README.md"), quoted);
  EXPECT_EQ(with_quotes("no markers", made_up_results(), "README.md"), "no markers");
}

TEST(Quotes, AMarkerThatCannotBeFilledIsRefused) {
  for (const char* document :
       {"<!-- bench: techniques hand -->\n", "<!-- bench: weather -->\n<!-- end of bench -->",
        "<!-- bench: techniques foot -->\n<!-- end of bench -->", "<!-- bench: "})
    expect_error(ErrorCode::kBadInput, "README.md",
                 [&] { with_quotes(document, made_up_results(), "README.md"); });
}

}  // namespace
}  // namespace mdk::test
