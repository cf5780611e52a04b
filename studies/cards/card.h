#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Benchmark cards: a problem stated so that any program can compute it, what the answer is, how well it is
/// known and from where; and the judgement of an answer.
namespace flowrest::studies::cards {

/// A number that an answer is held against.
struct Target {
  std::string quantity;      ///< a column of history.csv: its name holds the unit, "spread_mm"
  std::optional<double> at;  ///< s; nothing: the last value, or one that does not hang on time
  double value = 0.0;        ///< in the quantity's unit
  double uncertainty = 0.0;  ///< plus or minus, likewise, above 0
  std::string note = {};     ///< how to read it, where that is not plain
};

/// What one of flowrest's own methods gave.
struct Known {
  std::string method;    ///< "material points, 10 mm"
  std::string answer;    ///< in words, with units
  std::string measured;  ///< the date and file under docs/measured
};

struct Card {
  std::string name;       ///< the file's stem
  std::string title;      ///< a line
  std::string statement;  ///< the whole problem, in SI units
  std::string source;     ///< where the targets come from
  std::string command;    ///< how flowrest computes it; empty where it cannot yet
  std::vector<Target> targets;
  std::vector<Known> known;
};

/// A card by its name, or by its file's path. @throws scenes::SceneError naming file, line and what is allowed.
Card load_card(const std::string& name_or_path);
Card parse_card(const std::string& text, const std::filesystem::path& path);

/// The names of those that flowrest brings, in order.
std::vector<std::string> card_names();

/// A target with its answer.
struct Judged {
  enum class Verdict {
    agrees,  ///< within twice what target and answer are uncertain by, together
    misses,  ///< further away
    absent   ///< the answer has no such value
  };
  Target target;
  std::optional<double> answer;
  double answer_uncertainty = 0.0;  ///< of the run's own telling
  Verdict verdict = Verdict::absent;
  std::string why = {};  ///< of what is absent
};
std::string to_string(Judged::Verdict);

/// Holds a run directory, or a CSV file, against a card. A CSV file has a column time_s and one for each
/// quantity, or the columns quantity and value. @throws runs::RunError where it cannot be read.
std::vector<Judged> judge(const Card&, const std::filesystem::path& answer);

/// Whether every target is met.
bool agrees(const std::vector<Judged>&);

/// The card and the judgement as text for a terminal, and the judgement on one line for programs.
std::string shown(const Card&);
std::string shown(const std::vector<Judged>&);
std::string to_json(const Card&, const std::vector<Judged>&);

}  // namespace flowrest::studies::cards
