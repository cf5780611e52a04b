#include "compare/report/report.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>

#include "compare/report/sources.h"

namespace flowrest::compare {

using Json = nlohmann::ordered_json;

namespace {

/// Samples of a history in the page: dense early, where most happens, and few enough to draw at once.
constexpr int history_samples = 700;

std::string escaped_html(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

/// Text of the page in which no number is parted from its unit at the end of a line.
std::string prose_html(const std::string& text) {
  static const std::regex unit("([0-9]) (mm/s|mm|m/s|s|min|h|%|Pa)");
  return std::regex_replace(escaped_html(text), unit, "$1&nbsp;$2");
}

/// JSON that may stand inside a script element.
std::string script_json(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    // "</script" and "<!--" would end or change the element; within JSON strings \u003c is the same
    // character.
    if (text[i] == '<')
      safe += "\\u003c";
    else
      safe += text[i];
  }
  return safe;
}

std::string chart_library() {
  std::ifstream file(FLOWREST_CHART_JS, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (text.empty())
    throw runs::MissingProgram(
        fmt::format("the report needs Chart.js, which is not at {}; get it by: apt-get install "
                    "libjs-chart.js",
                    FLOWREST_CHART_JS));
  return text;
}

Json rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0;
  const double power = std::pow(10.0, digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  return std::isfinite(power) ? Json(std::round(value * power) / power) : Json(0);
}

Json page_data(const Comparison& comparison, const Json& comparison_json) {
  const bool slump = comparison.kind == scenes::Kind::slump;
  const double scale = slump ? 1e3 : 1.0;
  Json data = {
      {"comparison", comparison_json},
      {"end", comparison.end},
      {"gauge",
       slump ? Json{{"name", "spread"}, {"unit", "mm"}} : Json{{"name", "plug velocity"}, {"unit", "m/s"}}},
      {"coordinate", slump ? Json{{"name", comparison.radial ? "radius" : "distance"}, {"unit", "mm"}}
                           : Json{{"name", "height above the mid-plane"}, {"unit", "mm"}}},
      {"value",
       slump ? Json{{"name", "depth"}, {"unit", "mm"}} : Json{{"name", "velocity"}, {"unit", "m/s"}}}};
  for (const char* list : {"time", "grid", "frames", "runs"}) data[list] = Json::array();
  std::vector<double> time;
  for (int i = 0; i <= history_samples; ++i)
    time.push_back(comparison.end * std::pow(static_cast<double>(i) / history_samples, 1.7));
  for (const double t : time) data["time"].push_back(rounded(t, 5));
  for (const double x : comparison.grid) data["grid"].push_back(rounded(1e3 * x, 6));
  for (const double t : comparison.frames) data["frames"].push_back(rounded(t, 6));
  for (const RunView& view : comparison.runs) {
    Json run = {
        {"held_from", view.held && view.measures.end && !view.exact ? Json(*view.measures.end) : Json()},
        {"exact", view.exact},
        {"gauge", Json::array()},
        {"shear_rate", Json::array()},
        {"profiles", Json::array()}};
    for (const double t : time) {
      const auto value = view.gauge_at(t);
      run["gauge"].push_back(value ? rounded(scale * *value, 5) : Json());
    }
    if (!view.shear_rate.empty())
      for (const double t : time)
        run["shear_rate"].push_back(t <= view.shear_rate.end() && t >= view.shear_rate.time.front()
                                        ? rounded(view.shear_rate.at(t), 3)
                                        : Json());
    for (const double t : comparison.frames) {
      const auto profile = view.profile(t, comparison.grid);
      Json values;
      if (profile)
        for (const double v : *profile)
          values.push_back(slump ? rounded(std::round(1e5 * v) / 1e2, 5) : rounded(v, 5));
      run["profiles"].push_back(values);
    }
    data["runs"].push_back(run);
  }
  data["scene"] = comparison.runs.front().run.info.value("scene", "");
  return data;
}

void replace(std::string& page, std::string_view mark, std::string_view text) {
  const auto at = page.find(mark);
  if (at == std::string::npos) throw std::logic_error(fmt::format("the page has no {}", mark));
  page.replace(at, mark.size(), text);
}

}  // namespace

std::string report_page(const Comparison& comparison, const Json& comparison_json) {
  // The first paragraph says when and where it stops; its first sentence is set large.
  std::map<Finding::Topic, std::string> words;
  for (const Finding& finding : comparison.findings) {
    std::string& paragraph = words[finding.topic];
    const bool opening = finding.topic == Finding::Topic::stop && paragraph.empty();
    const std::string text = prose_html(finding.text);
    paragraph += opening ? fmt::format("<span class=\"opening\">{}</span> ", text) : text + ' ';
  }
  std::string lead, notes;
  const std::pair<Finding::Topic, const char*> order[] = {{Finding::Topic::stop, "lead"},
                                                          {Finding::Topic::difference, "difference"},
                                                          {Finding::Topic::context, "context"}};
  for (const auto& [topic, id] : order)
    if (words.contains(topic)) lead += fmt::format("<p id=\"{}\">{}</p>\n", id, words[topic]);
  for (const std::string& note : comparison.notes)
    notes += fmt::format("<p class=\"note\">{}</p>\n", prose_html(note));
  std::string page(sources::page_html());
  // From the end of the page to its start: the first occurrence of a mark is then always the template's own.
  replace(page, "{{script}}", sources::page_js());
  replace(page, "{{chart}}", chart_library());
  replace(page, "{{data}}", script_json(page_data(comparison, comparison_json)));
  replace(page, "{{fair}}", prose_html(comparison.fair));
  replace(page, "{{notes}}", notes);
  replace(page, "{{lead}}", lead);
  replace(page, "{{heading}}", escaped_html(comparison.title));
  replace(page, "{{style}}", sources::page_css());
  replace(page, "{{title}}", escaped_html(comparison.title));
  return page;
}

}  // namespace flowrest::compare
