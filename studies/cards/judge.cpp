#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "compare/measures/series.h"
#include "runs/columns.h"
#include "runs/run_directory.h"
#include "studies/cards/card.h"

namespace flowrest::studies::cards {

namespace fs = std::filesystem;

namespace {

/// An answer: series over time, or numbers by name.
class Answer {
 public:
  explicit Answer(const fs::path& path) {
    std::error_code error;
    if (fs::is_directory(path, error)) {
      table_ = runs::read_run(path).history;
      return;
    }
    const runs::CsvText text = runs::read_csv_text(path);
    const auto& names = text.header.cells;
    if (std::find(names.begin(), names.end(), "quantity") != names.end())
      read_numbers(text);
    else
      table_ = runs::read_csv(path, true);
    if (numbers_.empty() && !table_.has("time_s"))
      throw runs::RunError(fmt::format(
          "{}: no answer to a card; allowed: a run directory, a CSV file with the column time_s and one for each "
          "quantity, or one with the columns quantity and value",
          path.string()));
  }

  /// The value of a quantity, and how well the run says that it knows it.
  void give(Judged& judged) const {
    const Target& target = judged.target;
    if (!numbers_.empty()) {
      const auto found = std::find_if(numbers_.begin(), numbers_.end(),
                                      [&](const auto& number) { return number.first == target.quantity; });
      if (found == numbers_.end())
        judged.why = "there is no " + target.quantity;
      else
        judged.answer = found->second;
      return;
    }
    judged.answer = at(target, target.quantity, judged.why);
    std::string no_reason;
    if (judged.answer && target.quantity == runs::column::spread.name)
      judged.answer_uncertainty = at(target, runs::column::spread_uncertainty.name, no_reason).value_or(0.0);
  }

 private:
  void read_numbers(const runs::CsvText& text) {
    const auto& names = text.header.cells;
    const auto column = [&](const char* name) {
      const auto found = std::find(names.begin(), names.end(), name);
      if (found == names.end())
        throw runs::RunError(fmt::format("{}: there is no column {}; needed: quantity and value",
                                         text.place(text.header), name));
      return static_cast<std::size_t>(found - names.begin());
    };
    const std::size_t quantity = column("quantity"), value = column("value");
    for (const auto& row : text.rows) {
      const auto number = row.cells.size() > value ? text.number(row.cells[value]) : std::nullopt;
      if (!number || row.cells.size() <= quantity)
        throw runs::RunError(text.place(row) + ": the value is no number");
      numbers_.emplace_back(row.cells[quantity], *number);
    }
  }

  std::optional<double> at(const Target& target, const std::string& name, std::string& why) const {
    if (!table_.has(name)) {
      why = "there is no column " + name;
      return std::nullopt;
    }
    const auto &time = table_.at("time_s"), &value = table_.at(name);
    if (time.empty()) {
      why = "there is no row";
      return std::nullopt;
    }
    double read = value.back();
    if (target.at) {
      constexpr double rounding = 1e-9;
      if (*target.at < time.front() || *target.at > time.back() * (1.0 + rounding)) {
        why = fmt::format("it goes from {:g} to {:g} s", time.front(), time.back());
        return std::nullopt;
      }
      read = compare::interpolate(time, value, std::min(*target.at, time.back()));
    }
    if (std::isfinite(read)) return read;
    why = "it reads nothing there";
    return std::nullopt;
  }

  runs::Table table_;
  std::vector<std::pair<std::string, double>> numbers_;
};

/// A number with its target's digits: to a tenth of the uncertainty.
std::string digits(double value, double uncertainty) {
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(uncertainty))), 0, 9);
  return fmt::format("{:.{}f}", value, decimals);
}

}  // namespace

std::string to_string(Judged::Verdict verdict) {
  switch (verdict) {
    case Judged::Verdict::agrees:
      return "agrees";
    case Judged::Verdict::misses:
      return "misses";
    case Judged::Verdict::absent:
      return "absent";
  }
  return "";
}

std::vector<Judged> judge(const Card& card, const fs::path& path) {
  const Answer answer(path);
  std::vector<Judged> all;
  for (const Target& target : card.targets) {
    Judged judged;
    judged.target = target;
    answer.give(judged);
    if (judged.answer) {
      const double known = 2.0 * std::hypot(target.uncertainty, judged.answer_uncertainty);
      judged.verdict = std::abs(*judged.answer - target.value) <= known ? Judged::Verdict::agrees
                                                                        : Judged::Verdict::misses;
    }
    all.push_back(judged);
  }
  return all;
}

bool agrees(const std::vector<Judged>& all) {
  return std::all_of(all.begin(), all.end(),
                     [](const Judged& j) { return j.verdict == Judged::Verdict::agrees; });
}

std::string shown(const Card& card) {
  std::string text = fmt::format("{}\n\n{}\n\nSource: {}\n", card.title, card.statement, card.source);
  if (!card.command.empty()) text += fmt::format("With flowrest: {}\n", card.command);
  text += "\n";
  for (const Target& t : card.targets)
    text += fmt::format("  {}{}: {} +- {}{}\n", t.quantity, t.at ? fmt::format(" at {:g} s", *t.at) : "",
                        digits(t.value, t.uncertainty), digits(t.uncertainty, t.uncertainty),
                        t.note.empty() ? "" : " (" + t.note + ")");
  for (const Known& k : card.known)
    text += fmt::format("  known: {}: {} ({})\n", k.method, k.answer, k.measured);
  return text;
}

std::string shown(const std::vector<Judged>& all) {
  std::string text;
  for (const Judged& j : all) {
    const Target& t = j.target;
    const std::string what = t.quantity + (t.at ? fmt::format(" at {:g} s", *t.at) : "");
    if (!j.answer) {
      text += fmt::format("?? {}: absent, {}\n", what, j.why);
      continue;
    }
    const double difference = *j.answer - t.value;
    text +=
        fmt::format("{} {}: {}, target {} +- {}, {} ({:+.2f} of its uncertainty)\n",
                    j.verdict == Judged::Verdict::agrees ? "ok" : "!!", what,
                    digits(*j.answer, t.uncertainty), digits(t.value, t.uncertainty),
                    digits(t.uncertainty, t.uncertainty), to_string(j.verdict), difference / t.uncertainty);
  }
  return text;
}

std::string to_json(const Card& card, const std::vector<Judged>& all) {
  nlohmann::ordered_json json{{"card", card.name}, {"agrees", agrees(all)}};
  auto& targets = json["targets"] = nlohmann::ordered_json::array();
  for (const Judged& j : all) {
    nlohmann::ordered_json one{{"quantity", j.target.quantity}};
    if (j.target.at) one["time_s"] = *j.target.at;
    one["target"] = j.target.value;
    one["uncertainty"] = j.target.uncertainty;
    one["answer"] = j.answer ? nlohmann::ordered_json(*j.answer) : nlohmann::ordered_json();
    one["verdict"] = to_string(j.verdict);
    targets.push_back(std::move(one));
  }
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace flowrest::studies::cards
