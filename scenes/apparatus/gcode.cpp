#include "scenes/apparatus/gcode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>

#include "scenes/text.h"

namespace flowrest::scenes {

namespace {

constexpr std::size_t most_faults = 8;
constexpr const char* understood = "G0, G1, G4, G20, G21, G90, G91, G92, M82, M83";

/// A letter and its number: X12.5
struct Word {
  char letter = 0;
  double value = 0.0;
};

/// A line without its comments.
std::string bare(const std::string& line) {
  std::string text;
  bool comment = false;
  for (const char c : line) {
    if (c == ';') break;
    if (c == '(') comment = true;
    if (!comment) text += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    if (c == ')') comment = false;
  }
  return text;
}

/// The words of a line; nothing, where something is no word, which is then in `wrong`.
std::optional<std::vector<Word>> words_of(const std::string& text, std::string& wrong) {
  std::vector<Word> words;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if (std::isspace(static_cast<unsigned char>(*at))) {
      ++at;
      continue;
    }
    const char* const begin = at;
    Word word{*at++, 0.0};
    if (at != end && *at == '+') ++at;
    const auto [next, error] = std::from_chars(at, end, word.value);
    if (word.letter < 'A' || word.letter > 'Z' || error != std::errc() || !std::isfinite(word.value)) {
      wrong = std::string(begin, std::find_if(begin, end, [](unsigned char c) { return std::isspace(c); }));
      return std::nullopt;
    }
    at = next;
    words.push_back(word);
  }
  return words;
}

/// The machine that a code moves.
class Printer {
 public:
  explicit Printer(double volume_per_e) : volume_per_e_(volume_per_e) {}

  /// @return what is wrong; empty where nothing is
  std::string take(const std::vector<Word>& words) {
    const Word& command = words.front();
    const int number = static_cast<int>(std::lround(command.value));
    if (command.value == number) {
      if (command.letter == 'G' && (number == 0 || number == 1)) return move(words);
      if (command.letter == 'G' && number == 4) return dwell(words);
      if (command.letter == 'G' && number == 92) return set_place(words);
      if (command.letter == 'G' && number == 20) return units_ = 0.0254, "";
      if (command.letter == 'G' && number == 21) return units_ = 0.001, "";
      if (command.letter == 'G' && number == 90) return relative_ = relative_e_ = false, "";
      if (command.letter == 'G' && number == 91) return relative_ = relative_e_ = true, "";
      if (command.letter == 'M' && number == 82) return relative_e_ = false, "";
      if (command.letter == 'M' && number == 83) return relative_e_ = true, "";
    }
    return fmt::format("{}{:g} is not understood; allowed: {}", command.letter, command.value, understood);
  }

  PrintedPath path;
  bool any_e = false;

 private:
  std::string move(const std::vector<Word>& words) {
    std::array<double, 3> to = place_;
    double e = e_;
    for (std::size_t i = 1; i < words.size(); ++i) {
      const auto& [letter, value] = words[i];
      if (letter >= 'X' && letter <= 'Z') {
        const auto axis = static_cast<std::size_t>(letter - 'X');
        to[axis] = (relative_ ? to[axis] : 0.0) + units_ * value;
      } else if (letter == 'E') {
        e = (relative_e_ ? e_ : 0.0) + value;
        any_e = true;
      } else if (letter == 'F') {
        constexpr double minute = 60.0;
        speed_ = units_ * value / minute;
        if (!(speed_ > 0.0)) return fmt::format("F{:g} is no speed; allowed: greater than 0", value);
      } else {
        return fmt::format("{}{:g} is not understood; allowed in a move: X, Y, Z, E, F", letter, value);
      }
    }
    if (path.places.empty()) {
      if (e != e_) return "E counts before the nozzle is anywhere; allowed: a move without E first";
      place_ = to;
      path.places.push_back({0.0, to[0], to[1], to[2]});
      return "";
    }
    const double length = std::hypot(to[0] - place_[0], to[1] - place_[1], to[2] - place_[2]);
    const double fed = (e - e_) * volume_per_e_;
    if (fed < 0.0) return fmt::format("E falls by {:g}; allowed: E that does not draw concrete back", e_ - e);
    if (length == 0.0 && fed == 0.0) return "";
    if (!(speed_ > 0.0)) return "the nozzle moves before there is a speed; allowed: F in this move or before";
    if (length == 0.0)
      return "E counts while the nozzle stands; allowed: E in a move, or process.extrusion_velocity";
    const double takes = length / speed_;
    hold(fed / takes);
    time_ += takes;
    place_ = to;
    e_ = e;
    path.places.push_back({time_, to[0], to[1], to[2]});
    return "";
  }

  std::string dwell(const std::vector<Word>& words) {
    double pause = 0.0;
    for (std::size_t i = 1; i < words.size(); ++i) {
      if (words[i].letter == 'P')
        pause += 1e-3 * words[i].value;
      else if (words[i].letter == 'S')
        pause += words[i].value;
      else
        return fmt::format("{}{:g} is not understood; allowed in G4: P, S", words[i].letter, words[i].value);
    }
    if (pause < 0.0) return "a pause is negative; allowed: from 0";
    if (pause == 0.0 || path.places.empty()) return "";
    hold(0.0);
    time_ += pause;
    path.places.push_back({time_, place_[0], place_[1], place_[2]});
    return "";
  }

  std::string set_place(const std::vector<Word>& words) {
    for (std::size_t i = 1; i < words.size(); ++i) {
      if (words[i].letter != 'E')
        return fmt::format("G92 {} would move the bed under the nozzle; allowed: G92 E", words[i].letter);
      e_ = words[i].value;
    }
    return "";
  }

  void hold(double flow) {
    if (path.flow.empty() || path.flow.back().second != flow) path.flow.emplace_back(time_, flow);
  }

  double volume_per_e_, units_ = 0.001, speed_ = 0.0, time_ = 0.0, e_ = 0.0;
  bool relative_ = false, relative_e_ = false;
  std::array<double, 3> place_{};
};

}  // namespace

GcodeResult read_gcode(const std::string& text, double volume_per_e) {
  GcodeResult result;
  Printer printer(volume_per_e);
  std::istringstream lines(text);
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::string wrong;
    auto words = words_of(bare(line), wrong);
    if (words && !words->empty() && words->front().letter == 'N') words->erase(words->begin());
    if (words && words->empty()) continue;
    const std::string fault =
        words ? printer.take(*words) : fmt::format("{} is no word of a G-code", quoted(wrong));
    if (fault.empty()) continue;
    result.faults.push_back(fmt::format("line {}: {}", number, fault));
    if (result.faults.size() == most_faults) return result;
  }
  if (result.faults.empty() && printer.path.places.size() < 2)
    result.faults.emplace_back("the nozzle moves nowhere; allowed: two moves or more");
  if (!result.faults.empty()) return result;
  if (printer.any_e)
    printer.path.flow.emplace_back(printer.path.places.back()[0], 0.0);
  else
    printer.path.flow.clear();
  result.path = std::move(printer.path);
  return result;
}

}  // namespace flowrest::scenes
