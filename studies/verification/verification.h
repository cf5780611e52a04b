#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/measures/grid_convergence.h"
#include "compare/report/page.h"
#include "runs/verdict.h"

/// Every exactly known case, on three grids or more, in each scheme, model, precision and solver for which it
/// makes sense: errors, observed orders, grid convergence, and verdicts against stated bounds.
namespace flowrest::studies::verification {

/// What one computation of a case says.
struct Measured {
  double error = 0.0;  ///< in the case's norm, against what is exactly known
  double value = 0.0;  ///< the quantity that grid convergence is judged by, in the case's unit
};

/// What a computation may use.
struct Workplace {
  std::filesystem::path folder;  ///< of this computation alone
  std::function<bool()> interrupted = [] { return false; };
};

/// One case in one variant.
struct Case {
  std::string name;        ///< "Poiseuille flow, Bingham"
  std::string variant;     ///< "MPM quadratic-apic, elasto-viscoplastic, double"
  std::string against;     ///< what is exactly known, and its source
  std::string norm;        ///< of the error: "relative L2 of the velocity"
  std::string value_name;  ///< "plug velocity"
  std::string value_unit;
  std::optional<double> exact_value;    ///< of the value, in its unit
  std::string refined = "cell";         ///< what the grids differ in
  std::vector<double> grids;            ///< sizes, coarse to fine
  std::optional<double> largest_error;  ///< bound on the error on the finest grid
  double round_off = 1e-10;             ///< errors below it say nothing of the grid
  std::optional<double> least_order;    ///< bound on the order between the two finest grids
  bool quick = false;                   ///< part of the subset that CI makes
  double cost = 1.0;                    ///< CPU s of its finest grid, roughly: what to start first
  std::function<Measured(double grid, const Workplace&)> compute;
};

/// What a case gave.
struct Finding {
  Case of;
  struct OnGrid {
    double grid = 0.0;
    std::optional<Measured> measured;
    std::string trouble;  ///< why there is none
    double cpu = 0.0;     ///< s of wall time of this computation
    runs::Doubt doubt{};  ///< of the run's own verdict, where a run was made
  };
  std::vector<OnGrid> grids;
  std::vector<std::optional<double>> orders;            ///< of the errors, between neighbouring grids
  std::optional<compare::GridConvergence> convergence;  ///< of the values on the three finest grids
  bool passed = false;
  bool judged = false;  ///< bounds were stated
  std::string verdict;  ///< in words, with the bound
};

/// Every case; those of OpenFOAM where this build has it.
std::vector<Case> all_cases();
std::vector<Case> duct_cases();   ///< scenes, by MPM and OpenFOAM
std::vector<Case> slump_cases();  ///< scenes against asymptotes
std::vector<Case> body_cases();   ///< bodies made by hand
std::vector<Case> derivative_cases();

/// Fills orders, convergence and the verdict from what was measured.
void judge(Finding&);

struct Options {
  bool quick = false;
  int jobs = 0;      ///< 0: all cores
  std::string only;  ///< cases whose name or variant holds this text
  bool quiet = false;
};

/// Computes the cases, several at once. Interrupted, it returns what there is.
std::vector<Finding> verify(const std::vector<Case>&, const std::filesystem::path& folder, const Options&);

nlohmann::ordered_json to_json(const std::vector<Finding>&);
std::string to_csv(const std::vector<Finding>&);
report::Page page_of(const std::vector<Finding>&);

}  // namespace flowrest::studies::verification
