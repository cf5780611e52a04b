#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/measures/grid_convergence.h"
#include "studies/job.h"
#include "studies/study.h"

/// What a study found: the error of each run against its cost.
namespace flowrest::studies {

/// A quantity of the reference.
struct ReferenceValue {
  double value = 0.0;
  std::optional<double> uncertainty;  ///< in the quantity's unit; none where nothing says how sure it is
  std::string words;                  ///< where it comes from, and how it converged
};

/// What became of one point.
enum class Verdict {
  sound,
  under_resolved,  ///< by its own verdict, and no worse
  noisy,           ///< by its own verdict
  refused,         ///< with a reason, before it began
  stopped,         ///< with a reason and its data
  unsound,         ///< it calls itself sound and is not: silently wrong
  crashed,
  too_long,
  missing
};
std::string to_string(Verdict);
/// Whether its error says what a run is worth. Coarse runs belong to the trade as much as fine ones; what is
/// noisy may be right by chance.
bool is_worth_its_error(Verdict);

struct Result {
  Point point;
  Verdict verdict = Verdict::missing;
  std::string reason;
  std::map<std::string, double> values;  ///< by quantity, in its unit
  std::map<std::string, double> errors;  ///< relative to the reference, absolute values
  std::map<std::string, bool> pareto;    ///< whether no run of the same solver is both cheaper and better
  double cpu = 0.0;                      ///< s
  double wall = 0.0;                     ///< s
  double memory = 0.0;                   ///< bytes, the peak; 0 where unknown
  std::string version;                   ///< the commit of flowrest that made it
  std::string machine;                   ///< the processor it ran on
};

/// What changing one setting costs and buys, over all pairs of runs that differ in nothing else.
struct Price {
  std::string sweep, key, from, to;
  std::size_t pairs = 0;
  double cpu_ratio = 0.0;                      ///< median
  double memory_ratio = 0.0;                   ///< median; 0 where unknown
  std::map<std::string, double> change;        ///< median of the values' relative change, by quantity
  std::map<std::string, double> error_change;  ///< median change of the relative error
};

struct Results {
  Study study;
  std::string cut;
  std::map<std::string, ReferenceValue> reference;
  std::vector<Result> results;  ///< points, then the runs of the reference
  std::vector<Price> prices;
  std::optional<compare::Limit> limit;
  std::string limit_words, limit_basis;
  std::vector<std::string> notes;  ///< what a reader must know before trusting anything
  std::vector<std::string> findings;
};

/// Reads whatever runs there are.
Results collect(const Folder&, const Study&, const std::vector<Point>&, const std::string& cut);

nlohmann::ordered_json to_json(const Results&);
std::string to_csv(const Results&);

/// Writes study.json, points.csv and index.html.
void write_results(const Folder&, const Results&);

}  // namespace flowrest::studies
