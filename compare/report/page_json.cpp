#include "compare/report/page_json.h"

#include <fmt/format.h>

#include <cmath>
#include <span>
#include <stdexcept>

namespace flowrest::report {

using Json = nlohmann::ordered_json;

namespace {

/// Of the numbers a page draws: more digits than any screen can show.
constexpr int digits = 6;

Json number(double value) {
  if (!std::isfinite(value)) return nullptr;
  if (value == 0.0) return 0;
  const double power = std::pow(10.0, digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value)))));
  const double rounded = std::round(value * power) / power;
  return std::isfinite(rounded) ? Json(rounded) : Json(value);
}

Json number(const std::optional<double>& value) { return value ? number(*value) : Json(); }

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(number(value));
  return list;
}

Json bytes(std::span<const std::uint8_t> values) {
  static constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((values.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < values.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, values.size() - i);
    std::uint32_t word = static_cast<std::uint32_t>(values[i]) << 16;
    if (count > 1) word |= static_cast<std::uint32_t>(values[i + 1]) << 8;
    if (count > 2) word |= values[i + 2];
    for (std::size_t k = 0; k < 4; ++k)
      text += k <= count ? letters[(word >> (18 - 6 * static_cast<int>(k))) & 63u] : '=';
  }
  return text;
}

/// Little endian, as browsers read them.
Json words(const std::vector<std::uint16_t>& values) {
  std::vector<std::uint8_t> split;
  split.reserve(2 * values.size());
  for (const std::uint16_t value : values) {
    split.push_back(static_cast<std::uint8_t>(value & 0xffu));
    split.push_back(static_cast<std::uint8_t>(value >> 8));
  }
  return bytes(split);
}

Json json_of(const Axis& axis) {
  return {{"name", axis.name},         {"unit", axis.unit},         {"log", axis.logarithmic},
          {"switch", axis.can_switch}, {"from", number(axis.from)}, {"to", number(axis.to)}};
}

Json json_of(const Plot& plot) {
  Json curves = Json::array();
  for (const Curve& curve : plot.curves)
    curves.push_back({{"name", curve.name},
                      {"entry", curve.entry},
                      {"colour", curve.colour},
                      {"dash", curve.dash},
                      {"x", numbers(curve.x)},
                      {"y", numbers(curve.y)},
                      {"hover", curve.hover},
                      {"line", curve.line},
                      {"marks", curve.marks},
                      {"held_from", number(curve.held_from)},
                      {"low", numbers(curve.low)},
                      {"high", numbers(curve.high)}});
  return {{"type", "plot"},   {"x", json_of(plot.x)}, {"y", json_of(plot.y)},
          {"curves", curves}, {"tall", plot.tall},    {"focus", number(plot.focus)}};
}

Json json_of(const Bars& bars) {
  Json groups = Json::array();
  for (const auto& group : bars.groups)
    groups.push_back({{"name", group.name}, {"values", numbers(group.values)}});
  return {{"type", "bars"},
          {"x", json_of(bars.x)},
          {"categories", bars.categories},
          {"groups", groups},
          {"stacked", bars.stacked}};
}

Json json_of(const Frames& frames) {
  Json curves = Json::array();
  for (const auto& curve : frames.curves) {
    Json values = Json::array();
    for (const auto& frame : curve.values) values.push_back(numbers(frame));
    curves.push_back({{"entry", curve.entry}, {"values", values}});
  }
  return {{"type", "frames"},
          {"clock", frames.clock},
          {"times", numbers(frames.times)},
          {"grid", json_of(frames.grid)},
          {"value", json_of(frames.value)},
          {"coordinate", numbers(frames.coordinate)},
          {"curves", curves},
          {"upright", frames.upright}};
}

Json json_of(const Section::Panel& panel) {
  Json json = {{"entry", panel.entry}, {"missing", panel.missing}, {"size", number(panel.size)}};
  if (!panel.west.empty()) {
    json["west"] = words(panel.west);
    json["east"] = words(panel.east);
    json["bottom"] = words(panel.bottom);
    json["top"] = words(panel.top);
  }
  json["frames"] = Json::array();
  for (const auto& frame : panel.frames) {
    Json entry = {{"time", number(frame.time)}, {"values", Json::array()}};
    if (!frame.x.empty()) entry["x"] = words(frame.x);
    if (!frame.z.empty()) entry["z"] = words(frame.z);
    if (!frame.cover.empty()) entry["cover"] = bytes(frame.cover);
    for (const auto& values : frame.values) entry["values"].push_back(bytes(values));
    json["frames"].push_back(entry);
  }
  return json;
}

Json json_of(const Section& section) {
  Json quantities = Json::array(), panels = Json::array();
  for (const auto& quantity : section.quantities)
    quantities.push_back({{"name", quantity.name},
                          {"unit", quantity.unit},
                          {"from", number(quantity.from)},
                          {"to", number(quantity.to)},
                          {"log", quantity.logarithmic}});
  for (const auto& panel : section.panels) panels.push_back(json_of(panel));
  return {{"type", "section"},       {"clock", section.clock},          {"x", json_of(section.x)},
          {"z", json_of(section.z)}, {"times", numbers(section.times)}, {"quantities", quantities},
          {"panels", panels},        {"to_scale", section.to_scale}};
}

const char* name_of(Format::Kind kind) {
  switch (kind) {
    case Format::Kind::significant:
      return "significant";
    case Format::Kind::fixed:
      return "fixed";
    case Format::Kind::signed_fixed:
      return "signed";
  }
  return "";
}

Json json_of(const Table& table) {
  Json columns = Json::array(), rows = Json::array();
  for (const Column& column : table.columns)
    columns.push_back({{"name", column.name},
                       {"unit", column.unit},
                       {"format", {{"kind", name_of(column.format.kind)}, {"digits", column.format.digits}}},
                       {"text", column.text},
                       {"key", column.key}});
  for (const auto& row : table.rows) {
    Json cells = Json::array();
    for (const auto& cell : row.cells)
      if (const auto* value = std::get_if<double>(&cell))
        cells.push_back(std::isfinite(*value) ? Json(*value) : Json());
      else if (const auto* text = std::get_if<std::string>(&cell))
        cells.push_back(*text);
      else
        cells.push_back(nullptr);
    rows.push_back({{"cells", cells}, {"entry", row.entry}, {"badge", row.badge}, {"choice", row.choice}});
  }
  return {{"type", "table"}, {"columns", columns}, {"rows", rows}, {"choice", table.choice}};
}

Json json_of(const Map& map) {
  static constexpr const char* verdicts[] = {"sound", "refused", "stopped", "warning", "wrong"};
  Json cells = Json::array();
  for (const auto& cell : map.cells)
    cells.push_back({{"row", cell.row},
                     {"column", cell.column},
                     {"verdict", verdicts[static_cast<int>(cell.verdict)]},
                     {"text", cell.text},
                     {"hover", cell.hover}});
  return {{"type", "map"},    {"row_name", map.row_name}, {"column_name", map.column_name},
          {"rows", map.rows}, {"columns", map.columns},   {"cells", cells}};
}

template <class T>
concept Figure = requires(const T& block) {
  block.caption;
};

void require(bool holds, const std::string& id, const std::string& what) {
  if (!holds) throw std::logic_error(fmt::format("figure {}: {}", id, what));
}

void check_entry(int entry, std::size_t entries, const std::string& id) {
  require(entry < static_cast<int>(entries), id, fmt::format("entry {} of {}", entry, entries));
}

void check(const Plot& plot, std::size_t entries) {
  for (const Curve& curve : plot.curves) {
    check_entry(curve.entry, entries, plot.id);
    const std::size_t size = curve.x.size();
    require(curve.y.size() == size, plot.id, fmt::format("{} x and {} y", size, curve.y.size()));
    require(curve.hover.empty() || curve.hover.size() == size, plot.id, "a hover text a point is expected");
    require(curve.low.size() == curve.high.size() && (curve.low.empty() || curve.low.size() == size), plot.id,
            "an interval a point is expected");
    require(curve.entry >= 0 || !curve.name.empty(), plot.id, "a curve without an entry needs a name");
  }
}

void check(const Bars& bars, std::size_t) {
  for (const auto& group : bars.groups)
    require(group.values.size() == bars.categories.size(), bars.id,
            fmt::format("{} values for {} categories", group.values.size(), bars.categories.size()));
}

void check(const Frames& frames, std::size_t entries) {
  require(!frames.times.empty(), frames.id, "no times");
  for (const auto& curve : frames.curves) {
    require(curve.entry >= 0, frames.id, "a curve needs an entry");
    check_entry(curve.entry, entries, frames.id);
    require(curve.values.size() == frames.times.size(), frames.id, "a frame a time is expected");
    for (const auto& frame : curve.values)
      require(frame.empty() || frame.size() == frames.coordinate.size(), frames.id,
              "a value a grid point is expected");
  }
}

void check(const Section& section, std::size_t entries) {
  require(!section.times.empty() && !section.quantities.empty(), section.id, "no times or no quantity");
  require(section.x.from && section.x.to && section.z.from && section.z.to, section.id, "no extent");
  for (const auto& panel : section.panels) {
    require(panel.entry >= 0, section.id, "a panel needs an entry");
    check_entry(panel.entry, entries, section.id);
    for (const auto& frame : panel.frames) {
      const std::size_t count = panel.west.empty() ? frame.x.size() : panel.west.size();
      require(frame.z.size() == frame.x.size(), section.id, "as many z as x are expected");
      require(panel.west.empty() || frame.cover.size() == count, section.id, "a cover a cell is expected");
      require(frame.values.size() == section.quantities.size(), section.id,
              "a list of values a quantity is expected");
      for (const auto& values : frame.values)
        require(values.empty() || values.size() == count, section.id,
                "a value a particle or cell is expected");
    }
  }
}

void check(const Table& table, std::size_t entries) {
  for (const auto& row : table.rows) {
    check_entry(row.entry, entries, table.id);
    require(row.cells.size() == table.columns.size(), table.id,
            fmt::format("{} cells in {} columns", row.cells.size(), table.columns.size()));
  }
}

void check(const Map& map, std::size_t) {
  for (const auto& cell : map.cells)
    require(cell.row < map.rows.size() && cell.column < map.columns.size(), map.id, "a cell lies outside");
}

}  // namespace

std::string id_of(const Block& block) {
  return std::visit(
      []<class T>(const T& own) -> std::string {
        if constexpr (Figure<T>)
          return own.id;
        else
          return "";
      },
      block);
}

std::string title_of(const Block& block) {
  return std::visit(
      []<class T>(const T& own) -> std::string {
        if constexpr (Figure<T>)
          return own.title;
        else
          return "";
      },
      block);
}

std::string caption_of(const Block& block) {
  return std::visit(
      []<class T>(const T& own) -> std::string {
        if constexpr (Figure<T>)
          return own.caption;
        else
          return "";
      },
      block);
}

void check(const Block& block, std::size_t entries) {
  std::visit(
      [&]<class T>(const T& own) {
        if constexpr (Figure<T>) check(own, entries);
      },
      block);
}

Json page_json(const Page& page, const std::vector<const Block*>& figures) {
  Json json = {
      {"kind", page.kind}, {"title", page.title}, {"entries", Json::array()}, {"blocks", Json::array()}};
  for (const Entry& entry : page.entries)
    json["entries"].push_back({{"name", entry.name},
                               {"colour", entry.colour},
                               {"dash", entry.dash},
                               {"doubt", entry.doubt},
                               {"why", entry.why},
                               {"trouble", entry.trouble}});
  for (const Block* figure : figures) {
    Json block = std::visit(
        []<class T>(const T& own) -> Json {
          if constexpr (Figure<T>) {
            Json made = json_of(own);
            made["id"] = own.id;
            made["title"] = own.title;
            made["caption"] = own.caption;
            return made;
          } else {
            return Json();
          }
        },
        *figure);
    json["blocks"].push_back(std::move(block));
  }
  json["data"] = page.data;
  return json;
}

}  // namespace flowrest::report
