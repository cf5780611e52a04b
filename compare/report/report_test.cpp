#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <regex>

#include "compare/comparison.h"
#include "compare/exact/exact_run.h"
#include "compare/report/browser.h"
#include "compare/report/figures.h"
#include "compare/report/page.h"
#include "compare/report/picture_size.h"
#include "compare/synthetic_runs.h"
#include "runs/process.h"
#include "runs/temporary_folder.h"
#include "runs/test_variable.h"

using namespace flowrest;
using namespace flowrest::compare;
using runs::Variable;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class ReportTest : public testing::Test {
 protected:
  /// Two runs, at rest and creeping, one of them noisy, with the exact profiles.
  void write_slump_report() {
    synthetic::Slump arrested;
    arrested.end = 20.0;
    arrested.status = runs::Status::at_rest;
    synthetic::write(arrested, folder / "runs" / "evp");
    synthetic::Slump fluid;
    fluid.solver = "foam";
    fluid.model = scenes::Model::papanastasiou;
    fluid.creep = 2.5e-4;
    fluid.verdict = "noisy: the initial residual rose to 0.12";
    synthetic::write(fluid, folder / "runs" / "foam");
    exact::write_exact_runs(scenes::load_scene("roussel-slump"), folder / "runs" / "exact");
    write_comparison(compare_runs(find_runs({folder / "runs"})), folder / "report");
  }

  void open(const std::string& hash = "", const std::string& report = "report") {
    if (!browser) browser = std::make_unique<report::Browser>(folder);
    browser->window(1280, 900);
    browser->open(folder / report / "index.html", hash);
  }
  report::Browser& page() { return *browser; }
  /// Brings a figure before the eye and waits until it is drawn.
  void show(const std::string& id) {
    page().evaluate("document.getElementById('" + id + "').scrollIntoView()");
    ASSERT_TRUE(page().wait_for("document.querySelector('#" + id + " .body').children.length > 0")) << id;
  }
  /// A picture of what is seen, kept where FLOWREST_SCREENSHOTS names a folder.
  void look(const std::string& name) {
    if (const char* kept = std::getenv("FLOWREST_SCREENSHOTS"))
      page().screenshot(fs::path(kept) / (name + ".png"));
  }

  runs::TemporaryFolder temporary;
  fs::path folder = temporary.path();
  std::unique_ptr<report::Browser> browser;  // goes before the folder
};

/// Tests that open the page.
class OpenedReportTest : public ReportTest {
 protected:
  void SetUp() override {
    if (report::browser_program().empty())
      GTEST_SKIP() << "the page cannot be opened: Chromium is not installed (apt-get install chromium)";
  }
  void TearDown() override {
    if (browser) {
      EXPECT_THAT(browser->complaints(), testing::IsEmpty());
    }
  }
};

}  // namespace

TEST_F(ReportTest, StandsByItself) {
  write_slump_report();
  const std::string page = text_of(folder / "report" / "index.html");
  EXPECT_LT(page.size(), 3'000'000u);
  const std::regex load(
      "(src|href)\\s*=\\s*[\"']?\\s*(https?:)?//|url\\(\\s*[\"']?(https?:)?//|@import|fetch\\(\\s*[\"']http");
  std::smatch match;
  EXPECT_FALSE(std::regex_search(page, match, load)) << match.str() << match.suffix().str().substr(0, 100);
  EXPECT_THAT(page, Not(HasSubstr("{{")));
  // The words stand in the page itself: they can be read without its script.
  const auto begin = page.find("<section class=\"first\"");
  ASSERT_NE(begin, std::string::npos);
  const std::string first = page.substr(begin, page.find("</section>", begin) - begin);
  EXPECT_THAT(first, HasSubstr("MPM elasto-viscoplastic comes to rest after 20&nbsp;s with a spread of "
                               "576&nbsp;±&nbsp;10&nbsp;mm"));
  EXPECT_THAT(first, HasSubstr("noisy: OpenFOAM papanastasiou.</p>"))
      << "the first sentence lacks the warning";
  EXPECT_THAT(first, HasSubstr("noisy: the initial residual rose to 0.12"));
  EXPECT_THAT(first, HasSubstr("(make it by <code>flowrest foam roussel-slump --model bi-viscous</code>)"));
}

TEST_F(ReportTest, TextOfASceneIsNoMarkup) {
  synthetic::write(synthetic::Slump{}, folder / "runs" / "evp");
  const fs::path json = folder / "runs" / "evp" / "run.json";
  auto info = nlohmann::ordered_json::parse(text_of(json));
  info["title"] = "</script><script>alert(1)</script> & {{data}}";
  runs::write_atomically(json, info.dump());
  write_comparison(compare_runs({folder / "runs" / "evp"}), folder / "report");
  const std::string page = text_of(folder / "report" / "index.html");
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt; &amp; {{data}}"));
}

TEST_F(OpenedReportTest, DrawsEveryFigureWithTitleUnitsAndWarnings) {
  write_slump_report();
  open();
  const auto ids = page().evaluate("[...document.querySelectorAll('figure')].map(f => f.id)");
  EXPECT_EQ(ids[0], "spread");
  ASSERT_GE(ids.size(), 8u);
  for (const auto& id : ids) show(id);
  EXPECT_EQ(page().evaluate("document.documentElement.dataset.drawn"), std::to_string(ids.size()));
  for (const auto& title :
       page().evaluate("[...document.querySelectorAll('figure .title')].map(t => t.textContent)"))
    EXPECT_THAT(title.get<std::string>(), testing::StartsWith("Roussel slump flow: "));
  for (const auto& axes : page().evaluate("[...document.querySelectorAll('.canvas canvas')].map(c => "
                                          "Object.values(Chart.getChart(c).options.scales).filter(s => "
                                          "s.title.display).map(s => s.title.text))")) {
    ASSERT_FALSE(axes.empty());
    for (const auto& name : axes) EXPECT_THAT(name.get<std::string>(), testing::MatchesRegex(".+ \\(.+\\)"));
  }
  EXPECT_EQ(page().evaluate("[...document.querySelectorAll('#spread .legend .key')].map(k => k.textContent)"),
            nlohmann::json({"MPM elasto-viscoplastic", "OpenFOAM papanastasiounoisy", "exact, leading order",
                            "exact, second order"}));
  EXPECT_EQ(page().evaluate("[...document.querySelectorAll('#measures tbody tr')].filter(r => "
                            "r.querySelector('th .badge')).length"),
            1);
  // Nothing is wider than the window, on a desk and on a telephone.
  page().window(360, 740, true);
  EXPECT_TRUE(
      page().wait_for("document.documentElement.scrollWidth <= document.documentElement.clientWidth"));
  page().evaluate("window.scrollTo(0, 0)");
  look("telephone");
}

TEST_F(OpenedReportTest, TheSliderMovesEveryFigureOfItsClock) {
  write_slump_report();
  open();
  show("profiles");
  const std::string centre =
      "Chart.getChart(document.querySelector('#profiles canvas')).data.datasets[0].data[0].y";
  const std::string shown = "document.querySelector('#profiles output').textContent";
  EXPECT_EQ(page().evaluate(shown), "60\u00a0s");
  EXPECT_NEAR(page().evaluate(centre).get<double>(), 39.6, 1.0);
  page().evaluate("document.querySelector('#profiles input[type=range]').focus()");
  page().press("Home");
  EXPECT_EQ(page().evaluate(shown), "0\u00a0s");
  EXPECT_GT(page().evaluate(centre).get<double>(), 250.0);
  EXPECT_EQ(page().evaluate("location.hash"), "#t=0");
  page().press("ArrowRight");
  EXPECT_NE(page().evaluate(shown), "0\u00a0s");
  EXPECT_EQ(page().evaluate("document.querySelector('#profiles .title').textContent"),
            "Roussel slump flow: depth profiles at " + page().evaluate(shown).get<std::string>());
  look("profiles");
  const auto [x, y] = page().place_of("#profiles .play");
  page().click(x, y);
  EXPECT_TRUE(page().wait_for("document.querySelector('#profiles input[type=range]').value > 5"))
      << "it does not play";
  page().click(x, y);
  EXPECT_EQ(page().evaluate("document.querySelector('#profiles .play').textContent"), "Play");
}

TEST_F(OpenedReportTest, ThePointerAndTheArrowKeysReadValues) {
  write_slump_report();
  open();
  show("spread");
  const auto [x, y] = page().place_of("#spread canvas");
  page().point(x, y);
  const std::string tooltip =
      "(() => { const t = Chart.getChart(document.querySelector('#spread canvas')).tooltip; return t "
      "&& t.opacity ? [...t.title, ...t.body.flatMap(b => b.lines)] : []; })()";
  ASSERT_TRUE(page().wait_for(tooltip + ".length == 5"));
  const auto lines = page().evaluate(tooltip);
  EXPECT_THAT(lines[0].get<std::string>(), testing::MatchesRegex("time [0-9.]+.+s"));
  EXPECT_THAT(lines[1].get<std::string>(),
              testing::MatchesRegex("MPM elasto-viscoplastic: 57[0-9](\\.[0-9])?.+mm"));
  EXPECT_THAT(lines[2].get<std::string>(), HasSubstr("OpenFOAM papanastasiou (noisy): "));
  look("hover");
  page().evaluate("document.querySelector('#spread canvas').focus()");
  page().press("End");
  EXPECT_THAT(page().evaluate("document.querySelector('#spread .spoken').textContent").get<std::string>(),
              testing::AllOf(HasSubstr("time 60.0"), HasSubstr("MPM elasto-viscoplastic")));
}

TEST_F(OpenedReportTest, ScalesLegendsAndTablesAnswerTheReader) {
  write_slump_report();
  open();
  show("spread");
  const std::string chart = "Chart.getChart(document.querySelector('#spread canvas'))";
  const auto tick = [&](int nth) {
    page().evaluate("document.querySelectorAll('#spread .controls input')[" + std::to_string(nth) +
                    "].click()");
  };
  EXPECT_GT(page().evaluate(chart + ".scales.y.min").get<double>(), 450.0);
  tick(2);
  EXPECT_LE(page().evaluate(chart + ".scales.y.min").get<double>(), 200.0);
  tick(0);
  tick(1);
  EXPECT_EQ(page().evaluate(chart + ".scales.x.type"), "logarithmic");
  EXPECT_EQ(page().evaluate(chart + ".scales.y.type"), "logarithmic");
  look("logarithmic");
  // A run hidden in one figure is hidden in all.
  show("stops");
  page().evaluate("document.querySelector('#spread .legend button').click()");
  EXPECT_EQ(page().evaluate("[" + chart + ".isDatasetVisible(0), " + chart +
                            ".isDatasetVisible(1), "
                            "Chart.getChart(document.querySelector('#stops canvas')).isDatasetVisible(0)]"),
            nlohmann::json({false, true, false}));
  // A table sorts by a column, and back.
  show("measures");
  const auto column = [&] {
    return page().evaluate(
        "[...document.querySelectorAll('#measures tbody td:nth-child(2)')].map(c => Number(c.textContent))");
  };
  const auto [x, y] = page().place_of("#measures thead th:nth-child(2) button");
  page().click(x, y);
  auto values = column().get<std::vector<double>>();
  EXPECT_EQ(values.size(), 4u);
  EXPECT_TRUE(std::is_sorted(values.begin(), values.end()));
  page().click(x, y);
  values = column().get<std::vector<double>>();
  EXPECT_TRUE(std::is_sorted(values.rbegin(), values.rend()));
  look("table");
}

TEST_F(OpenedReportTest, TheAddressRestoresTimeAxisAndTheme) {
  write_slump_report();
  open("#t=10&spread.x=log&theme=dark");
  show("spread");
  show("profiles");
  EXPECT_EQ(page().evaluate("document.querySelector('#profiles output').textContent"), "10\u00a0s");
  EXPECT_EQ(page().evaluate("Chart.getChart(document.querySelector('#spread canvas')).scales.x.type"),
            "logarithmic");
  EXPECT_EQ(page().evaluate("document.documentElement.dataset.theme"), "dark");
}

TEST_F(OpenedReportTest, LightAndDark) {
  write_slump_report();
  open();
  page().prefer("dark");
  show("spread");
  const std::string ground = "getComputedStyle(document.body.parentElement).backgroundColor";
  ASSERT_TRUE(page().wait_for(ground + " != 'rgb(255, 255, 255)'")) << "dark is not heeded";
  const auto dark = page().evaluate(ground);
  page().evaluate("window.scrollTo(0, 0)");
  look("dark");
  page().prefer("light");
  EXPECT_TRUE(page().wait_for(ground + " == 'rgb(255, 255, 255)'"));
  EXPECT_NE(dark, page().evaluate(ground));
  look("light");
  const auto [x, y] = page().place_of("#theme");
  page().click(x, y);
  page().click(x, y);
  EXPECT_TRUE(page().wait_for(ground + " == " + dark.dump())) << "the button does not choose dark";
  EXPECT_EQ(page().evaluate("location.hash"), "#theme=dark");
}

TEST_F(OpenedReportTest, EveryFigureOffersItsData) {
  write_slump_report();
  open();
  // What would be saved is caught before it is.
  page().evaluate(
      "window.saved = {}; const create = URL.createObjectURL; URL.createObjectURL = blob => { window.last = "
      "blob; "
      "return create(blob); }; HTMLAnchorElement.prototype.click = function () { const name = this.download; "
      "window.last.text().then(text => { window.saved[name] = text; }); }; 0");
  const auto buttons = page().evaluate(
      "[...document.querySelectorAll('.offers button, #save-all')].map(b => b.click()).length");
  const std::string count = "Object.keys(window.saved).length";
  ASSERT_TRUE(page().wait_for(count + " == " + buttons.dump())) << page().evaluate(count);
  EXPECT_THAT(page().evaluate("window.saved['spread.csv']").get<std::string>(),
              testing::StartsWith("curve,time (s),spread (mm)\nMPM elasto-viscoplastic,0,200"));
  EXPECT_EQ(page().evaluate("JSON.parse(window.saved['profiles.json']).columns[0]"), "time (s)");
  EXPECT_EQ(page().evaluate("JSON.parse(window.saved['comparison.json']).format"), "flowrest comparison");
  EXPECT_EQ(page().evaluate("window.saved['measures.csv'].split('\\n').length"), 6);
}

TEST_F(OpenedReportTest, OpensFromAFolderOfAnyName) {
  write_slump_report();
  const std::string name = "a b'c\"d$HOME#f;g{h}(i)ü%20?*[j]";
  fs::copy(folder / "report", folder / name);
  open("", name);
  show("spread");
}

TEST_F(OpenedReportTest, PrintsToACleanPdf) {
  write_slump_report();
  open();
  page().prefer("dark");
  const std::string pdf = page().pdf();
  ASSERT_TRUE(pdf.starts_with("%PDF-"));
  const std::regex sheet("/Type\\s*/Page[^s]");
  const auto sheets =
      std::distance(std::sregex_iterator(pdf.begin(), pdf.end(), sheet), std::sregex_iterator());
  EXPECT_GE(sheets, 3);
  EXPECT_LE(sheets, 14);
  EXPECT_LT(pdf.size(), 6'000'000u);
  // All figures were drawn for it, and the page is on the screen as before.
  EXPECT_EQ(
      page().evaluate("document.documentElement.dataset.drawn == document.documentElement.dataset.figures"),
      true);
  EXPECT_EQ(page().evaluate("document.documentElement.dataset.theme"), "dark");
  if (const char* kept = std::getenv("FLOWREST_SCREENSHOTS"))
    std::ofstream(fs::path(kept) / "report.pdf", std::ios::binary) << pdf;
}

/// A validation as it may come to be: scenes of four runs each, and a map.
report::Page large_page(int scenes) {
  report::Page page{.kind = "validation", .title = "All scenes"};
  for (const char* name : {"MPM solid", "MPM fluid", "OpenFOAM solid", "OpenFOAM fluid"}) {
    const int index = static_cast<int>(page.entries.size());
    page.entries.push_back({.name = name, .colour = index % 2, .dash = index / 2});
  }
  page.entries.back().doubt = "noisy";
  page.entries.back().why = "the residual rose";
  page.words = {report::Text{"Thirty scenes hold.", report::Text::Style::opening}};
  report::Plot pareto{
      .id = "pareto", .title = "error against cost", .x = {"CPU time", "s", true}, .y = {"error", "%", true}};
  pareto.curves.push_back({.entry = 0,
                           .x = {2.0, 20.0},
                           .y = {4.0, 1.0},
                           .hover = {"cell 20 mm", "cell 10 mm\nAPIC"},
                           .marks = true});
  page.figure = pareto;
  for (int scene = 0; scene < scenes; ++scene) {
    const std::string id = "scene-" + std::to_string(scene);
    report::Plot plot{.id = id + "-spread", .title = id, .x = {"time", "s"}, .y = {"spread", "mm"}};
    report::Table table{.id = id + "-table", .title = id, .columns = {{"Run"}, {"Spread", "mm"}}};
    for (int run = 0; run < 4; ++run) {
      report::Curve curve{.entry = run};
      for (int i = 0; i < 300; ++i) {
        curve.x.push_back(0.2 * i);
        curve.y.push_back(500.0 + 10.0 * run + 0.1 * i);
      }
      plot.curves.push_back(curve);
      table.rows.push_back(
          {.cells = {page.entries[static_cast<std::size_t>(run)].name, 530.0 + run}, .entry = run});
    }
    page.chapters.push_back({.id = id, .heading = id, .blocks = {plot, table}});
  }
  report::Map map{.id = "map",
                  .title = "stability",
                  .row_name = "yield stress",
                  .column_name = "CFL",
                  .rows = {"0", "50"},
                  .columns = {"0.5", "3"}};
  map.cells = {{0, 0, report::Map::Verdict::sound, "", ""},
               {1, 1, report::Map::Verdict::refused, "", "CFL above 1"}};
  page.chapters.push_back({.id = "extremes", .heading = "Extremes", .blocks = {map}});
  return page;
}

TEST_F(OpenedReportTest, ThirtyScenesOfFourRunsOpenAtOnce) {
  const std::string html = report::render(large_page(30));
  EXPECT_LT(html.size(), 3'000'000u);
  fs::create_directories(folder / "large");
  std::ofstream(folder / "large" / "index.html", std::ios::binary) << html;
  open("", "large");
  ASSERT_TRUE(page().wait_for("document.documentElement.dataset.drawn > 0"));
  EXPECT_EQ(page().evaluate("document.documentElement.dataset.figures"), "62");
  EXPECT_LT(page().evaluate("Number(document.documentElement.dataset.drawn)").get<int>(), 20);
  show("scene-29-spread");
  EXPECT_EQ(page().evaluate("document.querySelectorAll('#scene-29-spread .badge').length"), 1);
  // The settings behind a point, on hover.
  show("pareto");
  const auto [x, y] = page().place_of("#pareto canvas");
  page().point(x, y);
  EXPECT_TRUE(page().wait_for(
      "(() => { const t = Chart.getChart(document.querySelector('#pareto canvas')).tooltip; return t && "
      "t.body && t.body.some(b => b.lines.includes('APIC') || b.lines.includes('cell 20 mm')); })()"));
  show("map");
  EXPECT_EQ(page().evaluate("document.querySelector('#map td.refused').title"),
            "refused beforehand: CFL above 1");
}

TEST(Page, RefusesWhatCannotBeDrawn) {
  report::Page page = large_page(1);
  page.chapters[0].blocks.push_back(page.chapters[0].blocks[0]);
  EXPECT_THROW(report::render(page), std::logic_error) << "an id twice";
  page = large_page(1);
  std::get<report::Plot>(*page.figure).curves[0].y.pop_back();
  EXPECT_THROW(report::render(page), std::logic_error) << "x and y of different length";
  page = large_page(1);
  std::get<report::Table>(page.chapters[0].blocks[1]).rows[0].cells.pop_back();
  EXPECT_THROW(report::render(page), std::logic_error) << "a row that is too short";
}

TEST_F(ReportTest, FiguresForPapersAreDrawnAndCanBeDrawnAgain) {
  if (!runs::find_program("gnuplot"))
    GTEST_SKIP() << "gnuplot is not installed (apt-get install gnuplot-nox)";
  const auto written = report::write_figures(large_page(1), folder / "figures");
  EXPECT_THAT(written, testing::UnorderedElementsAre("pareto.svg", "pareto.png", "scene-0-spread.svg",
                                                     "scene-0-spread.png"));
  EXPECT_THAT(text_of(folder / "figures" / "scene-0-spread.svg"),
              testing::AllOf(HasSubstr("All scenes: scene-0"), HasSubstr("spread (mm)"),
                             HasSubstr("OpenFOAM fluid (noisy)")));
  auto coarse = large_page(1);
  coarse.entries.back().doubt = "under-resolved";
  report::write_figures(coarse, folder / "coarse");
  EXPECT_THAT(text_of(folder / "coarse" / "scene-0-spread.svg"),
              HasSubstr("OpenFOAM fluid (under-resolved)"));
  EXPECT_THAT(text_of(folder / "figures" / "pareto.png"), testing::StartsWith("\x89PNG"));
  EXPECT_GT(fs::file_size(folder / "figures" / "pareto.png"), 10'000u);
  EXPECT_TRUE(fs::exists(folder / "figures" / "figures.gp"));
  EXPECT_FALSE(fs::exists(folder / "figures" / "log.gnuplot"));
}

TEST_F(ReportTest, AClipShowsEveryTimeOfASection) {
  if (!runs::find_program("gnuplot") || !runs::find_program("ffmpeg"))
    GTEST_SKIP() << "gnuplot or ffmpeg is not installed (apt-get install gnuplot-nox ffmpeg)";
  report::Page page = large_page(0);
  report::Section section{
      .id = "section", .title = "particles", .x = {"radius", "mm"}, .z = {"height", "mm"}};
  section.x.from = section.z.from = 0.0;
  section.x.to = section.z.to = 300.0;
  section.quantities = {{.name = "shear rate", .unit = "1/s", .from = 1e-3, .to = 10.0, .logarithmic = true}};
  report::Section::Panel panel{.entry = 0, .size = 10.0};
  for (const double time : {0.0, 1.0, 2.0}) {
    section.times.push_back(time);
    panel.frames.push_back({.time = time, .x = {100, 30000}, .z = {100, 20000}, .values = {{10, 200}}});
  }
  section.panels = {panel};
  report::write_clip(page, section, folder / "clip.gif", true);
  EXPECT_THAT(text_of(folder / "clip.gif"), testing::StartsWith("GIF89a"));
  report::write_clip(page, section, folder / "clip.webm", true);
  EXPECT_THAT(text_of(folder / "clip.webm"), testing::StartsWith("\x1a\x45\xdf\xa3"));
  EXPECT_FALSE(fs::exists(folder / "clip.webm.frames"));
  const fs::path named = folder / "a b'c\"d$HOME#f;g{h}(i)ü%05d*[j].webm";
  report::write_clip(page, section, named, true);
  EXPECT_EQ(fs::file_size(named), fs::file_size(folder / "clip.webm"));

  std::ofstream(folder / "ffmpeg")
      << "#!/bin/sh\nexec /usr/bin/ffmpeg -loglevel quiet -i 00000.png film.webm\n";
  fs::permissions(folder / "ffmpeg", fs::perms::owner_all);
  const Variable path("PATH", folder.string() + ":" + std::getenv("PATH"));
  fs::remove(folder / "clip.webm");
  EXPECT_THROW(report::write_clip(page, section, folder / "clip.webm", true), runs::RunError)
      << "one of three times";
  EXPECT_FALSE(fs::exists(folder / "clip.webm"));
}

TEST_F(ReportTest, FiguresAreDrawnWithoutTheUsersSettingsInAFolderOfAnyName) {
  if (!runs::find_program("gnuplot"))
    GTEST_SKIP() << "gnuplot is not installed (apt-get install gnuplot-nox)";
  report::write_figures(large_page(1), folder / "plain");
  std::ofstream(folder / ".gnuplot") << "set title 'mine'\nset decimalsign ','\nexit\n";
  const Variable home("HOME", folder.string()), number("LC_ALL", "de_DE.UTF-8");
  const fs::path named = folder / "a b'c\"d$HOME#f;g{h}(i)ü%05d*[j]";
  report::write_figures(large_page(1), named);
  EXPECT_EQ(text_of(named / "pareto.svg"), text_of(folder / "plain" / "pareto.svg"));
  EXPECT_EQ(report::svg_size(named / "pareto.svg"), (report::PictureSize{720, 440}));
  EXPECT_EQ(report::png_size(named / "pareto.png"), (report::PictureSize{1584, 968}));
}

TEST_F(ReportTest, FiguresThatAreNotWhatWasAskedForAreRefused) {
  std::ofstream(folder / "gnuplot") << "#!/bin/sh\n[ -e ../svg ] && cp ../svg pareto.svg\nexit 0\n";
  fs::permissions(folder / "gnuplot", fs::perms::owner_all);
  const Variable path("PATH", folder.string() + ":/usr/bin:/bin");
  const auto refusal = [&]() -> std::string {
    try {
      report::write_figures(large_page(1), folder / "figures");
    } catch (const runs::RunError& error) {
      return error.what();
    }
    return "";
  };
  fs::create_directories(folder / "figures");
  std::ofstream(folder / "figures" / "pareto.svg") << "<svg width=\"720\" height=\"440\"></svg>";
  EXPECT_THAT(refusal(), HasSubstr("left no whole picture")) << "it was there before";
  std::ofstream(folder / "svg") << "<svg width=\"720\" height=\"440\">";
  EXPECT_THAT(refusal(), HasSubstr("left no whole picture"));
  std::ofstream(folder / "svg") << "<svg width=\"640\" height=\"480\"></svg>";
  EXPECT_THAT(refusal(), HasSubstr("gnuplot drew 640 x 480 where 720 x 440 was asked for"));
}

TEST_F(OpenedReportTest, ADuctAndARunWithoutARowOpenToo) {
  synthetic::write(synthetic::Duct{}, folder / "duct" / "evp");
  exact::write_exact_runs(scenes::load_scene("poiseuille-step-down"), folder / "duct" / "exact");
  write_comparison(compare_runs(find_runs({folder / "duct"})), folder / "report");
  open();
  for (const char* id : {"velocity", "profiles", "measures"}) show(id);
  look("duct");

  runs::RunWriter(folder / "failed", scenes::load_scene("roussel-slump"), "foam")
      .finish(runs::Status::failed, "the solver diverged", "sound");
  write_comparison(compare_runs({folder / "failed"}), folder / "report");
  open();
  EXPECT_EQ(page().evaluate("document.getElementById('profiles')"), nlohmann::json())
      << "an empty figure is shown";
  EXPECT_THAT(page().evaluate("document.querySelector('.words').textContent").get<std::string>(),
              HasSubstr("failed before the first record: the solver diverged"));
}
