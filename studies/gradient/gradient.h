#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mpm/derivatives/gradient.h"
#include "mpm/output/run.h"
#include "scenes/number_at.h"

namespace CLI {
class App;
}

/// `flowrest gradient`: how what comes out of a run changes with what goes in.
namespace flowrest::studies::gradient {

struct Options {
  std::string scene, model;
  std::vector<std::string> set;
  std::vector<std::string> of, by;  ///< quantities, and keys
  std::vector<std::string> sigma;   ///< "KEY=5%" or "KEY=2.5": standard uncertainties of keys
  std::filesystem::path output;     ///< empty: out/SCENE/gradient-MODEL
  std::string mode = "auto";        ///< or "forward", "reverse"
  double memory = 4e9;              ///< bytes at most for states kept to go backwards
  bool check = false, force = false, quiet = false;
};

/// The remainder |Q(k + h) - Q(k) - h dQ/dk| of a step h of a key; of a derivative that is right it falls as h^2.
struct Remainder {
  double relative_step;  ///< h / k
  double without;        ///< |Q(k + h) - Q(k)|
  double with;           ///< the remainder
};
/// (Q(k + h) - Q(k - h)) / 2h.
struct CentralDifference {
  double relative_step;
  double value;
};
/// What perturbed runs with the same steps say of a derivative.
struct Check {
  std::vector<Remainder> remainders;
  std::vector<CentralDifference> differences;
  double taylor_slope =
      0.0;              ///< of the remainders over the steps, in a logarithmic plot: 2 where it is right
  bool linear = false;  ///< the remainders are round-off from the largest step on: no slope to read
  double central_difference = 0.0;  ///< the one that its neighbours differ least from
  double relative_error = 0.0;      ///< of the derivative against it
};

struct Derivative {
  scenes::NumberAt key;
  double value = 0.0;       ///< the quantity's unit per the key's
  double elasticity = 0.0;  ///< d ln quantity / d ln key
  std::optional<Check> check;
  std::optional<double> sigma;  ///< the key's standard uncertainty, in its unit
};

/// One quantity's derivatives.
struct Gradient {
  mpm::derivatives::Quantity quantity{};
  std::string asked;  ///< the name it was asked for by
  /// Of the time at which a quantity reaches a value: that value, in its unit, and the quantity's own name and unit.
  std::optional<double> reaches = {};
  std::string reached_name = {}, reached_unit = {};
  double value = 0.0;            ///< in its unit
  std::optional<double> column;  ///< what the column of history.csv that it stands for reads
  std::vector<Derivative> by;
  /// Along a random direction of all keys: the derivative, and a central difference.
  double directional = 0.0, directional_difference = 0.0;
  std::string doubt;  ///< empty, or why it should not be believed

  double input_uncertainty() const;  ///< sqrt of the sum of (derivative sigma)^2
  bool has_sigma() const;
  double input_share(const Derivative&) const;  ///< of that, squared; 0 of a key without uncertainty
};

struct Cost {
  double forward_cpu = 0.0;   ///< s, of the run itself, by the kernels
  double plain_cpu = 0.0;     ///< s, of the run by the plain step
  double gradient_cpu = 0.0;  ///< s, of the derivatives
  double memory = 0.0;        ///< bytes that the derivatives took at most
  std::size_t steps = 0;
  std::size_t recomputed_steps = 0;  ///< that were made again to go backwards
};

struct Result {
  scenes::Scene scene;
  std::filesystem::path directory;
  std::string ended;  ///< how the run did: "at-rest", "end-time"
  std::string mode;
  std::vector<Gradient> gradients;
  std::vector<mpm::derivatives::Readings> over_time;
  Cost cost;
  bool sound = true;  ///< all gradients are
};

/// Makes the run, differentiates it and checks the result. Leaves the run's directory; see write().
/// @throws scenes::SceneError, runs::RunError before anything is written; runs::NumericsError where the run or
/// its derivatives are not finite; runs::Interrupted.
Result compute(const Options&);

/// gradient.json, gradient.csv, gradient_over_time.csv and gradient.html in the run directory.
void write(const Result&);

/// gradient.json.
nlohmann::ordered_json json_of(const Result&);
/// gradient.html.
std::string page_of(const Result&);

/// Adds `flowrest gradient`.
void add_command(CLI::App&);

}  // namespace flowrest::studies::gradient
