#include "studies/gradient/gradient.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <random>

#include "mpm/plain/solver.h"
#include "mpm/solver/settings.h"
#include "runs/console.h"
#include "runs/csv.h"
#include "runs/machine.h"
#include "runs/process.h"
#include "runs/progress.h"
#include "scenes/text.h"

namespace flowrest::studies::gradient {

namespace {

namespace derivatives = mpm::derivatives;
namespace fs = std::filesystem;

/// Of the directional check, and above which error a gradient is not believed.
constexpr double check_step = 1e-4, check_tolerance = 1e-2;

/// The scene in double precision, and refused where the plain step does not serve it.
scenes::Scene scene_of(const Options& options) {
  std::vector<std::string> set = options.set;
  if (!scenes::gives_key(set, "mpm.precision")) set.emplace_back("mpm.precision=double");
  scenes::Scene scene =
      scenes::load_scene(options.scene, scenes::overrides_of_command_line(set, options.model));
  if (scene.mpm.precision == scenes::Precision::single_precision)
    throw scenes::SceneError(
        fmt::format("{}: mpm.precision is single; allowed for derivatives: double", scene.path.string()));
  if (const std::string what = mpm::plain::not_served(mpm::settings_of(scene)); !what.empty())
    throw scenes::SceneError(
        fmt::format("{}: no derivative goes through {}; allowed: mpm.scheme = "
                    "\"quadratic-apic\"",
                    scene.path.string(), what));
  return scene;
}

std::vector<scenes::NumberAt> keys_of(const Options& options, const scenes::Scene& scene) {
  if (options.by.empty())
    throw scenes::SceneError("--by names no key; allowed: --by material.yield_stress,...");
  std::vector<scenes::NumberAt> keys;
  for (const std::string& path : options.by) {
    const std::string section = path.substr(0, path.find('.'));
    if (section == "mpm" || section == "foam" || section == "output" || section == "time" ||
        section == "gauges" || section == "geometry")
      throw scenes::SceneError(fmt::format(
          "{}: no derivative is taken by {}; allowed: keys of [material], [thixotropy], [walls] friction, "
          "[forces] and [process]",
          scene.path.string(), path));
    for (const scenes::NumberAt& other : keys)
      if (other.path == path) throw scenes::SceneError(fmt::format("--by names {} twice", path));
    keys.push_back(scenes::number_at(scene, path));
  }
  return keys;
}

/// The number that a text is, all of it.
std::optional<double> number_of(const std::string& text) {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && last == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// Standard uncertainties of keys, in their units: "5%" of the value, or a number.
std::vector<std::optional<double>> sigmas_of(const Options& options,
                                             const std::vector<scenes::NumberAt>& keys) {
  std::vector<std::optional<double>> sigmas(keys.size());
  for (const std::string& text : options.sigma) {
    const auto equals = text.rfind('=');
    const std::string path = text.substr(0, equals);
    std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
    const bool percent = !number.empty() && number.back() == '%';
    if (percent) number.pop_back();
    const std::optional<double> value = number_of(number);
    const auto key =
        std::find_if(keys.begin(), keys.end(), [&](const scenes::NumberAt& k) { return k.path == path; });
    if (!value || !(*value > 0.0))
      throw scenes::SceneError(
          fmt::format("--sigma {}: allowed: KEY=5% of its value, or KEY=NUMBER above 0 in its unit", text));
    if (key == keys.end())
      throw scenes::SceneError(fmt::format("--sigma {}: {} is not among --by", text, path));
    sigmas[static_cast<std::size_t>(key - keys.begin())] =
        percent ? 0.01 * *value * std::abs(key->value) : *value;
  }
  return sigmas;
}

/// When a series reaches a value: between which rows, and the share of the way from one to the next.
struct Crossing {
  std::size_t row;  ///< the one before it
  double share;
};
std::optional<Crossing> crossing_of(const std::vector<double>& series, double value) {
  for (std::size_t r = 0; r + 1 < series.size(); ++r) {
    const double a = series[r] - value, b = series[r + 1] - value;
    if (std::isfinite(a) && std::isfinite(b) && a != b && (a <= 0.0) != (b <= 0.0))
      return Crossing{r, a / (a - b)};
  }
  return std::nullopt;
}
double between(double a, double b, double share) { return a + share * (b - a); }

/// The slope of the logarithms of remainders over steps, of those above round-off.
double slope_of(const std::vector<Remainder>& remainders, double round_off, bool& linear) {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
  for (const Remainder& r : remainders) {
    if (!(r.with > round_off)) continue;
    const double u = std::log(r.relative_step), v = std::log(r.with);
    n += 1.0, x += u, y += v, xx += u * u, xy += u * v;
  }
  linear = n < 2.0;
  return linear ? 0.0 : (n * xy - x * y) / (n * xx - x * x);
}

class Work {
 public:
  explicit Work(const Options& options) : options_(options) {
    result_.scene = scene_of(options);
    const scenes::Scene& scene = result_.scene;
    keys_ = keys_of(options, scene);
    const auto sigmas = sigmas_of(options, keys_);
    std::vector<std::string> names;
    std::vector<double> values;
    for (const auto& key : keys_) {
      names.push_back(key.path);
      values.push_back(key.value);
    }
    variations_ = std::make_unique<derivatives::Variations>(
        names, values, [this](const std::vector<double>& at) { return scene_at(at); });
    std::vector<std::string> of = options.of;
    if (of.empty()) of.emplace_back(derivatives::quantities_of(variations_->centre()).front().name);
    for (const std::string& name : of) {
      Gradient g;
      g.asked = name;
      const auto equals = name.find('=');
      g.quantity = derivatives::quantity_named(name.substr(0, equals), variations_->centre());
      if (equals != std::string::npos) {
        g.reaches = number_of(name.substr(equals + 1));
        if (!g.reaches)
          throw scenes::SceneError(fmt::format("--of {}: allowed after =: the value that is reached, in {}",
                                               name, g.quantity.unit));
      }
      for (std::size_t k = 0; k < keys_.size(); ++k) {
        Derivative d;
        d.key = keys_[k];
        d.sigma = sigmas[k];
        g.by.push_back(d);
      }
      quantities_.push_back(g.quantity);
      if (g.reaches) {
        g.reached_name = g.quantity.name;
        g.reached_unit = g.quantity.unit;
        g.quantity.name = fmt::format("time_s at {}={:g}", g.quantity.name, *g.reaches);
        g.quantity.unit = "s";
        g.quantity.column = "";
        g.quantity.meaning = "the time at which that is reached, between the rows of history.csv";
      }
      result_.gradients.push_back(std::move(g));
    }
    choose_mode();
    result_.directory = options.output.empty() ? fs::path("out") / scene.name /
                                                     ("gradient-" + scenes::to_string(scene.material.model))
                                               : options.output;
  }

  Result make() {
    make_run();
    differentiate();
    check_direction();
    if (options_.check)
      for (std::size_t k = 0; k < keys_.size(); ++k) check_key(k);
    for (Gradient& g : result_.gradients) judge(g);
    return std::move(result_);
  }

 private:
  scenes::Scene scene_at(const std::vector<double>& values) const {
    std::vector<scenes::NumberAt> numbers = keys_;
    for (std::size_t k = 0; k < numbers.size(); ++k) numbers[k].value = values[k];
    return scenes::with_numbers(result_.scene, numbers);
  }

  void make_run() {
    mpm::RunOptions run;
    run.directory = result_.directory;
    run.quiet = options_.quiet;
    // Its own earlier run is made again: a recording lives no longer than the command.
    run.force = options_.force || fs::exists(result_.directory / "gradient.json");
    run.interrupted = [] { return runs::InterruptGuard::count() > 0; };
    derivatives::record(run, recording_);
    const double begin = runs::cpu_seconds();
    const mpm::RunResult made = mpm::run(result_.scene, run);
    result_.cost.forward_cpu = runs::cpu_seconds() - begin;
    if (made.status == runs::Status::interrupted) throw runs::Interrupted(made.reason);
    if (recording_.rows.empty())
      throw runs::RunError(fmt::format(
          "{}: this run is finished, and derivatives need its steps; allowed: --force, which makes it again, "
          "or -o with another folder",
          result_.directory.string()));
    result_.ended = runs::to_string(made.status);
    result_.cost.steps = recording_.steps.size();
    const runs::Table history = runs::read_csv(result_.directory / "history.csv");
    for (Gradient& g : result_.gradients)
      if (*g.quantity.column && history.has(g.quantity.column) && history.rows() > 0)
        g.column = history.at(g.quantity.column).back();
  }

  derivatives::Watch watch(runs::Progress& progress) const {
    return [&progress](double share) {
      if (runs::InterruptGuard::count() > 0)
        throw runs::Interrupted("interrupted before the derivatives were there; the same command makes them");
      progress.update(share, fmt::format("{:.0f} %", 100.0 * share));
    };
  }

  bool asks_for_times() const {
    return std::any_of(result_.gradients.begin(), result_.gradients.end(),
                       [](const Gradient& g) { return g.reaches.has_value(); });
  }

  /// About how many runs by the plain step derivatives cost: forward by the eights of keys, reverse by quantities.
  bool reverse_is_cheaper() const {
    constexpr double by_eight[] = {0.0, 3.0, 4.5, 6.0, 6.0, 10.0, 10.0, 10.0, 10.0}, backwards = 12.0;
    const std::size_t keys = keys_.size();
    const double forwards = static_cast<double>(keys / 8) * by_eight[8] + by_eight[keys % 8];
    return backwards * static_cast<double>(quantities_.size()) < forwards;
  }

  void choose_mode() {
    const std::string refused = derivatives::not_served_in_reverse(variations_->centre().settings);
    if (options_.mode == "reverse" && !refused.empty())
      throw scenes::SceneError(fmt::format("{}: --mode reverse does not serve {}; allowed: --mode forward",
                                           result_.scene.path.string(), refused));
    const bool times = asks_for_times();
    if (options_.mode == "reverse" && times)
      throw scenes::SceneError(fmt::format(
          "{}: --mode reverse does not serve the time at which a value is reached; allowed: --mode forward",
          result_.scene.path.string()));
    const bool backwards = options_.mode == "reverse" ||
                           (options_.mode == "auto" && refused.empty() && !times && reverse_is_cheaper());
    result_.mode = backwards ? "reverse" : "forward";
  }

  void differentiate() {
    const double begin = runs::cpu_seconds();
    runs::Progress progress("derivatives", 1.0, options_.quiet);
    if (result_.mode == "forward") {
      result_.over_time = derivatives::forward(*variations_, recording_, quantities_, watch(progress));
    } else {
      derivatives::ReverseCost cost;
      result_.over_time = {derivatives::reverse(*variations_, recording_, quantities_, options_.memory, cost,
                                                watch(progress))};
      result_.cost.memory = cost.memory;
      result_.cost.recomputed_steps = cost.recomputed_steps;
    }
    result_.cost.gradient_cpu = runs::cpu_seconds() - begin;
    progress.finish(
        fmt::format("{} steps, {:.3g} CPU s", recording_.steps.size(), result_.cost.gradient_cpu));
    const derivatives::Readings& last = result_.over_time.back();
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      Gradient& g = result_.gradients[q];
      const Slopes at = g.reaches ? slopes_at_crossing(q) : Slopes{last.value[q], last.slope[q]};
      g.value = at.value;
      for (std::size_t k = 0; k < keys_.size(); ++k) {
        g.by[k].value = at.slope[k];
        g.by[k].elasticity = g.by[k].value * keys_[k].value / g.value;
        if (!std::isfinite(g.by[k].value)) fail(g, k);
      }
    }
  }

  struct Slopes {
    double value;
    std::vector<double> slope;
  };
  /// Of the time at which a quantity reaches a value: the quantity's change at a fixed time, over how fast it goes.
  Slopes slopes_at_crossing(std::size_t q) const {
    const auto& rows = result_.over_time;
    const Gradient& g = result_.gradients[q];
    std::vector<double> series;
    for (const auto& row : rows) series.push_back(row.value[q]);
    const auto at = crossing_of(series, *g.reaches);
    if (!at)
      throw scenes::SceneError(fmt::format(
          "{}: {} never reaches {:g} {} in this run; allowed: a value between {:.6g} and {:.6g}",
          result_.scene.path.string(), g.reached_name, *g.reaches, g.reached_unit,
          *std::min_element(series.begin(), series.end()), *std::max_element(series.begin(), series.end())));
    const auto &before = rows[at->row], &after = rows[at->row + 1];
    const double speed = (after.value[q] - before.value[q]) / (after.time - before.time);
    Slopes slopes{between(before.time, after.time, at->share), {}};
    for (std::size_t k = 0; k < keys_.size(); ++k)
      slopes.slope.push_back(-between(before.slope[q][k], after.slope[q][k], at->share) / speed);
    return slopes;
  }

  /// Names when a derivative was lost.
  [[noreturn]] void fail(const Gradient& g, std::size_t key) const {
    const std::size_t q = static_cast<std::size_t>(&g - result_.gradients.data());
    double since = 0.0;
    for (const auto& row : result_.over_time)
      if (std::isfinite(row.slope[q][key])) since = row.time;
    throw runs::NumericsError(fmt::format(
        "{}: the derivative of {} by {} is not finite after {:g} s, or there is nothing to read; the run itself is "
        "in {}",
        result_.scene.path.string(), g.quantity.name, keys_[key].path, since, result_.directory.string()));
  }

  /// The readings at the end with keys moved by these shares of their values.
  std::vector<double> at(const std::vector<double>& shares) const {
    std::vector<double> values = variations_->values();
    for (std::size_t k = 0; k < values.size(); ++k) values[k] *= 1.0 + shares[k];
    if (runs::InterruptGuard::count() > 0)
      throw runs::Interrupted("interrupted before the gradient was checked; the same command makes it");
    const auto other = variations_->moved(values);
    // Times need all rows, readings at the end the last one.
    const bool times = asks_for_times();
    derivatives::Recording made = recording_;
    if (!times) made.rows = {recording_.rows.back()};
    const auto rows = derivatives::replayed(*other, variations_->centre(), made, quantities_);
    std::vector<double> readings = rows.back();
    for (std::size_t q = 0; q < readings.size(); ++q) {
      const auto& reaches = result_.gradients[q].reaches;
      if (!reaches) continue;
      std::vector<double> series;
      for (const auto& row : rows) series.push_back(row[q]);
      const auto at = crossing_of(series, *reaches);
      readings[q] = at ? between(made.rows[at->row].time, made.rows[at->row + 1].time, at->share)
                       : std::numeric_limits<double>::quiet_NaN();
    }
    return readings;
  }

  /// One random direction of all keys, each moved about as much of its value.
  void check_direction() {
    std::mt19937 random(20260101);
    std::uniform_real_distribution<double> size(0.5, 1.0);
    std::vector<double> up(keys_.size()), down(keys_.size());
    for (std::size_t k = 0; k < keys_.size(); ++k) {
      up[k] = check_step * size(random) * (random() % 2 == 0 ? 1.0 : -1.0);
      down[k] = -up[k];
    }
    if (!options_.quiet) runs::say(stderr, "derivatives: two runs by the plain step check them\n");
    const double begin = runs::cpu_seconds();
    const std::vector<double> above = at(up), below = at(down);
    result_.cost.plain_cpu = 0.5 * (runs::cpu_seconds() - begin);
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      Gradient& g = result_.gradients[q];
      g.directional = 0.0;
      for (std::size_t k = 0; k < keys_.size(); ++k)
        g.directional += g.by[k].value * keys_[k].value * up[k] / check_step;
      g.directional_difference = 0.5 * (above[q] - below[q]) / check_step;
    }
  }

  void check_key(std::size_t k) {
    std::vector<Check> checks(quantities_.size());
    std::vector<double> shares(keys_.size(), 0.0);
    for (int i = 0; i < 7; ++i) {
      const double share = 0.02 * std::pow(0.25, i);
      shares[k] = share;
      const std::vector<double> above = at(shares);
      shares[k] = -share;
      const std::vector<double> below = at(shares);
      for (std::size_t q = 0; q < quantities_.size(); ++q) {
        const Gradient& g = result_.gradients[q];
        const double h = share * keys_[k].value, change = above[q] - g.value;
        checks[q].remainders.push_back({share, std::abs(change), std::abs(change - h * g.by[k].value)});
        checks[q].differences.push_back({share, (above[q] - below[q]) / (2.0 * h)});
      }
    }
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      Check& c = checks[q];
      Gradient& g = result_.gradients[q];
      c.taylor_slope = slope_of(c.remainders, 1e-11 * std::abs(g.value), c.linear);
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i + 1 < c.differences.size(); ++i) {
        const double apart = std::abs(c.differences[i + 1].value - c.differences[i].value);
        if (apart >= least) continue;
        least = apart;
        c.central_difference = c.differences[i + 1].value;
      }
      c.relative_error = std::abs(g.by[k].value / c.central_difference - 1.0);
      g.by[k].check = std::move(c);
    }
  }

  void judge(Gradient& g) {
    double scale = 0.0;
    for (std::size_t k = 0; k < keys_.size(); ++k) scale += std::abs(g.by[k].value * keys_[k].value);
    const double error = std::abs(g.directional - g.directional_difference);
    if (!(error <= check_tolerance * scale))
      g.doubt = fmt::format(
          "fails its check: along a direction of all keys it is {:.4g}, a difference of {:g} % says {:.4g}",
          g.directional, 100.0 * check_step, g.directional_difference);
    for (const Derivative& d : g.by)
      if (d.check && !(d.check->relative_error <= check_tolerance) &&
          std::abs(d.value - d.check->central_difference) * std::abs(d.key.value) > check_tolerance * scale)
        g.doubt = fmt::format("fails its check: by {} it is {:.6g}, differences say {:.6g}", d.key.path,
                              d.value, d.check->central_difference);
    result_.sound = result_.sound && g.doubt.empty();
  }

  Options options_;
  Result result_;
  std::vector<scenes::NumberAt> keys_;
  std::unique_ptr<derivatives::Variations> variations_;
  std::vector<derivatives::Quantity> quantities_;
  derivatives::Recording recording_;
};

}  // namespace

double Gradient::input_uncertainty() const {
  double square = 0.0;
  for (const Derivative& d : by)
    if (d.sigma) square += d.value * d.value * *d.sigma * *d.sigma;
  return std::sqrt(square);
}

double Gradient::input_share(const Derivative& d) const {
  return d.sigma ? std::pow(d.value * *d.sigma / input_uncertainty(), 2.0) : 0.0;
}

bool Gradient::has_sigma() const {
  return std::any_of(by.begin(), by.end(), [](const Derivative& d) { return d.sigma.has_value(); });
}

Result compute(const Options& options) { return Work(options).make(); }

}  // namespace flowrest::studies::gradient
