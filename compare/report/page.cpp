#include "compare/report/page.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <stdexcept>

#include "compare/report/page_json.h"
#include "compare/report/sources.h"
#include "runs/run_directory.h"

namespace flowrest::report {

using Json = nlohmann::ordered_json;

namespace {

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

/// Text of the page in which no number is parted from its unit at the end of a line; what stands between
/// backticks is a command.
std::string prose(const std::string& text) {
  static const std::regex unit("([0-9]) (mm/s|mm|cm|m/s|m|s|min|h|%|Pa|kg|MiB|GiB)\\b"), plus_minus(" ± "),
      command("`([^`]*)`");
  std::string html = std::regex_replace(escaped(text), unit, "$1&nbsp;$2");
  html = std::regex_replace(html, plus_minus, "&nbsp;±&nbsp;");
  return std::regex_replace(html, command, "<code>$1</code>");
}

/// JSON that may stand inside a script element: "</script" and "<!--" would end or change it; within JSON
/// strings \u003c is the same character.
std::string script_json(const Json& json) {
  const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string safe;
  safe.reserve(text.size());
  for (const char c : text)
    if (c == '<')
      safe += "\\u003c";
    else
      safe += c;
  return safe;
}

std::string chart_library() {
  std::ifstream file(FLOWREST_CHART_JS, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (text.empty())
    throw runs::MissingProgram(fmt::format(
        "the report needs Chart.js, which is not at {}; get it by: apt-get install libjs-chart.js",
        FLOWREST_CHART_JS));
  return text;
}

std::string html_of(const Text& text) {
  switch (text.style) {
    case Text::Style::plain:
      return fmt::format("<p>{}</p>\n", prose(text.text));
    case Text::Style::opening:
      return fmt::format("<p class=\"opening\">{}</p>\n", prose(text.text));
    case Text::Style::soft:
      return fmt::format("<p class=\"soft\">{}</p>\n", prose(text.text));
    case Text::Style::warning:
      return fmt::format("<p class=\"note\" role=\"note\">{}</p>\n", prose(text.text));
    case Text::Style::small:
      return fmt::format("<p class=\"small\">{}</p>\n", prose(text.text));
  }
  return "";
}

std::string html_of(const Details& details) {
  std::string html = fmt::format("<details><summary>{}</summary>\n", escaped(details.summary));
  if (!details.facts.empty()) {
    html += "<dl>\n";
    for (const auto& [name, value] : details.facts)
      html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", escaped(name), escaped(value));
    html += "</dl>\n";
  }
  if (!details.text.empty()) html += fmt::format("<pre>{}</pre>\n", escaped(details.text));
  return html + "</details>\n";
}

std::string html_of(const Answer& answer) {
  std::string paragraphs;
  for (std::size_t from = 0, to = 0; to != std::string::npos; from = to + 1) {
    to = answer.text.find('\n', from);
    paragraphs += fmt::format("<dd>{}</dd>", prose(answer.text.substr(from, to - from)));
  }
  return fmt::format("<div><dt>{}</dt>{}</div>\n", prose(answer.question), paragraphs);
}

/// Writes blocks as HTML and gathers the figures among them, which the script draws.
class Writer {
 public:
  explicit Writer(const Page& page) : page_(page) {}

  std::string html(const std::vector<Block>& blocks) {
    std::string text;
    bool answering = false;
    for (const Block& block : blocks) {
      const auto* answer = std::get_if<Answer>(&block);
      if (answering != (answer != nullptr)) text += answer ? "<dl class=\"answers\">\n" : "</dl>\n";
      answering = answer != nullptr;
      text += answer ? html_of(*answer) : html(block);
    }
    return answering ? text + "</dl>\n" : text;
  }

  std::string html(const Block& block) {
    if (const auto* text = std::get_if<Text>(&block)) return html_of(*text);
    if (const auto* details = std::get_if<Details>(&block)) return html_of(*details);
    const std::string id = id_of(block);
    static const std::regex allowed("[A-Za-z][A-Za-z0-9_.-]*");
    if (!std::regex_match(id, allowed) || !ids_.insert(id).second)
      throw std::logic_error(fmt::format("the id '{}' is used twice or is none", id));
    check(block, page_.entries.size());
    const std::size_t number = figures_.size();
    figures_.push_back(&block);
    const bool moving = std::holds_alternative<Frames>(block) || std::holds_alternative<Section>(block);
    const std::string caption = caption_of(block);
    return fmt::format(
        "<figure id=\"{0}\" data-block=\"{1}\" aria-labelledby=\"{0}-title\">\n"
        "<div class=\"heading\"><p class=\"title\" id=\"{0}-title\">{2}{3}</p></div>\n<div "
        "class=\"body\"></div>\n{4}"
        "</figure>\n",
        id, number, prose(page_.title + ": " + title_of(block)), moving ? "<span class=\"when\"></span>" : "",
        caption.empty() ? "" : fmt::format("<figcaption>{}</figcaption>\n", prose(caption)));
  }

  std::string body() {
    std::string text;
    if (!page_.words.empty() || page_.figure) {
      text += "<section class=\"first\" aria-label=\"What was found\">\n";
      text += "<div class=\"words\">\n" + html(page_.words) + "</div>\n";
      if (page_.figure) text += html(*page_.figure);
      text += "</section>\n";
    }
    text += contents();
    for (const Chapter& chapter : page_.chapters) {
      if (!ids_.insert(chapter.id).second)
        throw std::logic_error(fmt::format("the id '{}' is used twice", chapter.id));
      text += fmt::format("<section id=\"{}\">\n<h{}>{}</h{}>\n{}</section>\n", escaped(chapter.id),
                          chapter.level, prose(chapter.heading), chapter.level, html(chapter.blocks));
    }
    return text;
  }

  const std::vector<const Block*>& figures() const { return figures_; }

 private:
  std::string contents() const {
    std::string items;
    for (const Chapter& chapter : page_.chapters)
      if (chapter.level == 2)
        items +=
            fmt::format("<li><a href=\"#{}\">{}</a></li>\n", escaped(chapter.id), prose(chapter.heading));
    return items.empty() ? "" : fmt::format("<nav aria-label=\"Contents\"><ol>\n{}</ol></nav>\n", items);
  }

  const Page& page_;
  std::set<std::string> ids_ = {"main", "data", "theme", "made"};
  std::vector<const Block*> figures_;
};

std::string made_by(const Json& provenance) {
  if (!provenance.is_object()) return "";
  const std::string hash = provenance.value("git_hash", "");
  return fmt::format("Made by flowrest {}{} at {}. Charts by Chart.js.", provenance.value("flowrest", ""),
                     hash.empty() ? ""
                                  : fmt::format(" ({}{})", hash.substr(0, 12),
                                                provenance.value("git_dirty", false) ? ", modified" : ""),
                     provenance.value("written", ""));
}

void replace(std::string& page, std::string_view mark, std::string_view text) {
  const auto at = page.find(mark);
  if (at == std::string::npos) throw std::logic_error(fmt::format("the page has no {}", mark));
  page.replace(at, mark.size(), text);
}

}  // namespace

std::string render(const Page& page) {
  Writer writer(page);
  std::string body = writer.body();
  if (!page.data.is_null())
    body += fmt::format(
        "<section id=\"all-data\">\n<h2>Data</h2>\n<p>Every figure and table offers its data above it. "
        "<button "
        "type=\"button\" id=\"save-all\">Save everything as {}.json</button></p>\n</section>\n",
        escaped(page.kind));
  std::string html(sources::page_html());
  // From the end of the page to its start: the first occurrence of a mark is then always the template's own.
  std::string script;
  for (const auto part : {sources::base_js(), sources::plots_js(), sources::sections_js(),
                          sources::tables_js(), sources::page_js()})
    script += part;
  replace(html, "{{script}}", script);
  replace(html, "{{chart}}", chart_library());
  replace(html, "{{data}}", script_json(page_json(page, writer.figures())));
  replace(html, "{{made}}", escaped(made_by(page.provenance)));
  replace(html, "{{body}}", body);
  replace(html, "{{heading}}", escaped(page.title));
  replace(html, "{{kind}}", escaped(page.kind));
  replace(html, "{{style}}", sources::page_css());
  replace(html, "{{title}}", escaped(page.title));
  return html;
}

}  // namespace flowrest::report
