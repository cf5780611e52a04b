#include "compare/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>

#include "compare/exact/exact_run.h"
#include "compare/synthetic_runs.h"

using namespace flowrest;
using namespace flowrest::compare;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

struct Outcome {
  int code = -1;
  std::string output;
};

Outcome shell(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return outcome;
  std::array<char, 65536> buffer{};
  for (std::size_t count; (count = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    outcome.output.append(buffer.data(), count);
  const int status = pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

/// The program that opens pages; empty where there is none.
std::string browser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    if (shell(std::string("command -v ") + name + " 2>/dev/null").code == 0) return name;
  return "";
}

/// A page as headless Chromium leaves it, and what it said on its console.
struct Opened {
  std::string dom;
  std::string console;
  /// What the probe wrote.
  nlohmann::json probe() const {
    std::smatch match;
    const std::regex mark("<pre id=\"probe\">([^<]*)</pre>");
    return std::regex_search(dom, match, mark) ? nlohmann::json::parse(match[1].str(), nullptr, false)
                                               : nlohmann::json();
  }
};

class ReportTest : public testing::Test {
 protected:
  ReportTest() : program(browser()) {
    std::string pattern = (fs::temp_directory_path() / "flowrest-report-XXXXXX").string();
    folder = mkdtemp(pattern.data());
  }
  ~ReportTest() override { fs::remove_all(folder); }

  /// Two runs at rest and creeping, one of them noisy, with the exact profiles.
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

  /// Opens the report with a script run after its own, the address ending in `hash`.
  Opened open(const std::string& script, const std::string& hash = "") const {
    std::string page = text_of(folder / "report" / "index.html");
    const std::string probe =
        "<script>(() => { const probe = document.createElement('pre'); probe.id = 'probe';"
        "const say = found => { probe.textContent = JSON.stringify(found); };" +
        script + "document.body.append(probe); })();</script></body>";
    const auto end = page.rfind("</body>");
    page.replace(end, 7, probe);
    std::ofstream(folder / "probed.html", std::ios::binary) << page;
    const std::string profile = (folder / "profile").string(), log = (folder / "log").string();
    const Outcome outcome = shell(
        "timeout 100 " + program +
        " --headless --no-sandbox --disable-gpu --disable-background-networking"
        " --disable-component-update --disable-sync --no-first-run --enable-logging=stderr --v=0"
        " --virtual-time-budget=5000 --window-size=1280,2400 --user-data-dir='" +
        profile + "' --dump-dom 'file://" + (folder / "probed.html").string() + hash + "' 2>'" + log + "'");
    Opened opened{outcome.output, ""};
    std::ifstream lines(log);
    for (std::string line; std::getline(lines, line);)
      if (line.find("CONSOLE") != std::string::npos) opened.console += line + '\n';
    EXPECT_EQ(outcome.code, 0) << text_of(log);
    return opened;
  }

  std::string program;
  fs::path folder;
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
  const auto lead = page.find("<p id=\"lead\">");
  ASSERT_NE(lead, std::string::npos);
  const std::string first = page.substr(lead, page.find("</p>", lead) - lead);
  EXPECT_THAT(
      first, HasSubstr("MPM elasto-viscoplastic comes to rest after 20&nbsp;s with a spread of 576&nbsp;mm"));
  EXPECT_THAT(first, HasSubstr("noisy: the initial residual rose to 0.12"));
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

TEST_F(ReportTest, DrawsAndAnswers) {
  if (program.empty())
    GTEST_SKIP() << "the page cannot be opened: Chromium is not installed (apt-get install chromium)";
  write_slump_report();
  const Opened opened = open(R"(
    const slider = document.getElementById('time'), shown = document.getElementById('time-shown');
    const profiles = Chart.getChart('chart-profiles'), gauge = Chart.getChart('chart-gauge');
    const centre = () => profiles.data.datasets[0].data[0].y;
    const found = {charts: document.documentElement.dataset.drawn, canvases: document.querySelectorAll('canvas').length};
    found.blank = [...document.querySelectorAll('canvas')].filter(c => c.offsetParent && !(c.width > 100 && c.height > 100)).map(c => c.id);
    found.last = shown.textContent; found.lastCentre = centre();
    slider.value = 0; slider.dispatchEvent(new Event('input'));
    found.first = shown.textContent; found.firstCentre = centre(); found.hash = location.hash;
    document.getElementById('log-time').click(); found.axis = gauge.options.scales.x.type;
    document.getElementById('whole').click(); found.whole = gauge.scales.y.min;
    document.querySelector('#runs input').click(); found.visible = [gauge.isDatasetVisible(0), gauge.isDatasetVisible(1)];
    const header = document.querySelector('#table-measures thead button');
    const firstRow = () => document.querySelector('#table-measures tbody th').textContent;
    header.click(); found.ascending = firstRow(); header.click(); found.descending = firstRow();
    found.legend = gauge.data.datasets.map(d => d.label);
    found.titles = [...document.querySelectorAll('canvas')].filter(c => c.offsetParent).map(c => Chart.getChart(c).options.plugins.title.text);
    found.noisyRows = [...document.querySelectorAll('#table-measures tbody tr')].filter(r => r.textContent.includes('noisy')).length;
    found.downloads = [...document.querySelectorAll('#downloads a')].map(a => a.download + ' ' + a.href.slice(0, 5));
    found.width = document.documentElement.scrollWidth - document.documentElement.clientWidth;
    say(found);
  )");
  EXPECT_EQ(opened.console, "");
  const auto found = opened.probe();
  ASSERT_TRUE(found.is_object()) << opened.dom.substr(0, 2000);
  EXPECT_EQ(found["charts"], "6");
  EXPECT_EQ(found["canvases"], 6);
  EXPECT_TRUE(found["blank"].empty()) << found["blank"];
  EXPECT_EQ(found["last"], "60 s");
  EXPECT_NEAR(found["lastCentre"].get<double>(), 39.6, 1.0);
  EXPECT_EQ(found["first"], "0 s");
  EXPECT_GT(found["firstCentre"].get<double>(), 250.0);
  EXPECT_EQ(found["hash"], "#t=0");
  EXPECT_EQ(found["axis"], "logarithmic");
  EXPECT_LE(found["whole"].get<double>(), 200.0);
  EXPECT_EQ(found["visible"], nlohmann::json({false, true}));
  EXPECT_NE(found["ascending"], found["descending"]);
  EXPECT_EQ(found["legend"], nlohmann::json({"MPM elasto-viscoplastic", "OpenFOAM papanastasiou (noisy)",
                                             "exact, leading order", "exact, second order"}));
  EXPECT_EQ(found["noisyRows"], 1);
  for (const auto& title : found["titles"])
    EXPECT_THAT(title.get<std::string>(), testing::StartsWith("Roussel slump flow: "));
  EXPECT_EQ(found["downloads"], nlohmann::json({"comparison.json blob:", "measures.csv blob:",
                                                "spread.csv blob:", "profiles.csv blob:"}));
  EXPECT_EQ(found["width"], 0) << "the page is wider than its window";
}

TEST_F(ReportTest, TheAddressRestoresTimeAndAxis) {
  if (program.empty())
    GTEST_SKIP() << "the page cannot be opened: Chromium is not installed (apt-get install chromium)";
  write_slump_report();
  const Opened opened = open(
      "say({time: document.getElementById('time-shown').textContent, log: "
      "document.getElementById('log-time').checked,"
      " title: Chart.getChart('chart-profiles').options.plugins.title.text});",
      "#t=10&axis=log");
  EXPECT_EQ(opened.console, "");
  const auto found = opened.probe();
  ASSERT_TRUE(found.is_object());
  EXPECT_EQ(found["time"], "10 s");
  EXPECT_EQ(found["log"], true);
  EXPECT_EQ(found["title"], "Roussel slump flow: depth profiles at 10 s");
}

TEST_F(ReportTest, ADuctAndARunWithoutARowOpenToo) {
  if (program.empty())
    GTEST_SKIP() << "the page cannot be opened: Chromium is not installed (apt-get install chromium)";
  synthetic::write(synthetic::Duct{}, folder / "duct" / "evp");
  exact::write_exact_runs(scenes::load_scene("poiseuille-step-down"), folder / "duct" / "exact");
  write_comparison(compare_runs(find_runs({folder / "duct"})), folder / "report");
  const std::string script =
      "say({charts: document.documentElement.dataset.drawn, profiles: "
      "document.getElementById('section-profiles').hidden});";
  Opened opened = open(script);
  EXPECT_EQ(opened.console, "");
  EXPECT_EQ(opened.probe()["charts"], "5");
  EXPECT_EQ(opened.probe()["profiles"], false);

  runs::RunWriter(folder / "failed", scenes::load_scene("roussel-slump"), "foam")
      .finish(runs::Status::failed, "the solver diverged", "sound");
  write_comparison(compare_runs({folder / "failed"}), folder / "report");
  opened = open(script);
  EXPECT_EQ(opened.console, "");
  EXPECT_EQ(opened.probe()["profiles"], true) << "an empty figure of profiles is shown";
  EXPECT_THAT(opened.dom, HasSubstr("failed before the first record: the solver diverged"));
}
