#include "mpm/derivatives/quantities.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "runs/columns.h"

namespace flowrest::mpm::derivatives {

const std::vector<Quantity>& quantities() {
  using namespace runs::column;
  static const std::vector<Quantity> all = {
      {Reading::spread, "smooth_spread_mm", spread_of_mass.name, "mm", 1e3,
       "twice the radius that holds 99.5 % of the mass, particles fading over half a cell"},
      {Reading::rms_radius, "rms_radius_mm", "", "mm", 1e3, "root of the mean square distance from the axis"},
      {Reading::centre_height, "smooth_height_mm", height.name, "mm", 1e3,
       "depth over a patch of three cells about the axis"},
      {Reading::front, "smooth_front_mm", front_of_mass.name, "mm", 1e3,
       "the place that 99.5 % of the mass has not passed, particles fading over half a cell"},
      {Reading::plug_velocity, "smooth_plug_velocity_m_s", plug_velocity.name, "m/s", 1.0,
       "velocity over a cell in the middle between the plates"},
      {Reading::mean_velocity, mean_velocity.name, mean_velocity.name, "m/s", 1.0, mean_velocity.meaning},
      {Reading::discharged, "smooth_discharged_fraction", discharged.name, "", 1.0,
       "share of the mass below the outlet, particles fading over a cell"},
      {Reading::strand_width, "smooth_strand_width_mm", strand_width.name, "mm", 1e3,
       "width of the strand's section behind the nozzle, the largest over a height that fades over a cell"},
      {Reading::strand_height, "smooth_strand_height_mm", strand_height.name, "mm", 1e3,
       "height of that section, the largest over a breadth that fades over a cell"},
      {Reading::section_area, "smooth_section_area_mm2", section_area.name, "mm2", 1e6,
       "its area, which fades over a cell at both ends"},
      {Reading::mean_height, "mean_height_mm", "", "mm", 1e3, "height of the centre of mass"},
      {Reading::flocculation, flocculation.name, flocculation.name, "", 1.0, flocculation.meaning},
      {Reading::kinetic_energy, kinetic_energy.name, kinetic_energy.name, "J", 1.0, kinetic_energy.meaning}};
  return all;
}

namespace {

bool has(const Variation& of, Reading reading) {
  const auto& gauged = of.pieces.gauged;
  switch (reading) {
    case Reading::spread:
    case Reading::rms_radius:
    case Reading::centre_height:
      return std::holds_alternative<scenes::SpreadGauge>(gauged);
    case Reading::front:
      return std::holds_alternative<scenes::ChannelGauge>(gauged);
    case Reading::plug_velocity:
    case Reading::mean_velocity:
      return std::holds_alternative<scenes::PlatesGauge>(gauged);
    case Reading::discharged:
      return std::holds_alternative<scenes::OutletGauge>(gauged);
    case Reading::strand_width:
    case Reading::strand_height:
    case Reading::section_area:
      return std::holds_alternative<scenes::SectionGauge>(gauged);
    case Reading::mean_height:
      return of.pieces.free_surface;
    case Reading::flocculation:
      return of.settings.thixotropic;
    case Reading::kinetic_energy:
      return true;
  }
  return false;
}

/// Where a function that rises and then falls is largest between two places, to a millionth of their distance.
template <class Function>
double place_of_largest(double low, double high, double grid, const Function& f) {
  double best = low, largest = f(low);
  for (double x = low; x <= high; x += grid)
    if (const double y = f(x); y > largest) {
      largest = y;
      best = x;
    }
  double from = std::max(low, best - grid), to = std::min(high, best + grid);
  constexpr double golden = 0.6180339887498949;
  while (to - from > 1e-6 * grid) {
    const double a = to - golden * (to - from), b = from + golden * (to - from);
    if (f(a) < f(b))
      from = a;
    else
      to = b;
  }
  return 0.5 * (from + to);
}

}  // namespace

std::vector<Quantity> quantities_of(const Variation& of) {
  std::vector<Quantity> own;
  for (const Quantity& q : quantities())
    if (has(of, q.reading)) own.push_back(q);
  return own;
}

Quantity quantity_named(const std::string& asked, const Variation& of) {
  const auto at = asked.find('@');
  const std::string name = asked.substr(0, at);
  std::vector<std::string> names;
  for (Quantity q : quantities_of(of)) {
    // Spreads and fronts of a depth end where the mass does.
    const bool of_depth = (name == runs::column::spread.name && q.reading == Reading::spread) ||
                          (name == runs::column::front.name && q.reading == Reading::front);
    names.push_back(q.name);
    if (name != q.name && name != q.column && !of_depth) continue;
    if (at == std::string::npos) return q;
    std::size_t end = 0;
    double place = -1.0;
    try {
      place = std::stod(asked.substr(at + 1), &end);
    } catch (const std::exception&) {
      end = 0;
    }
    const bool in_section = std::holds_alternative<scenes::SectionGauge>(of.pieces.gauged);
    if (!in_section || end != asked.size() - at - 1 || !(place > 0.0))
      throw scenes::SceneError(fmt::format(
          "{}: {}: allowed after @: metres above 0 from where the nozzle begins, for sections of printed strands",
          of.scene.path.string(), asked));
    q.place = place;
    q.name = fmt::format("{}@{:g}", q.name, place);
    q.column = "";
    return q;
  }
  throw scenes::SceneError(fmt::format("{}: no derivative is taken of \"{}\"; allowed: {}",
                                       of.scene.path.string(), name, fmt::join(names, ", ")));
}

template <int Dim>
Linearised::Linearised(const Quantity& quantity, const Variation& of,
                       const std::vector<plain::Particle<double, Dim>>& particles,
                       const Surroundings<double>& around)
    : quantity_(quantity), cell_(of.settings.cell), factor_(of.pieces.whole_over_computed) {
  double mass = 0.0;
  for (const auto& p : particles) mass += p.mass;
  const auto sum_at = [&](double level) {
    level_ = level;
    return sum_of_terms<Dim>(particles, around);
  };
  const auto extent = [&](std::size_t axis) {
    double farthest = 0.0;
    for (const auto& p : particles) farthest = std::max(farthest, std::abs(along<double, Dim>(p, axis)));
    return farthest + 2.0 * cell_;
  };
  if (is_quantile()) {
    double low = 0.0, high = std::hypot(extent(0), Dim == 3 ? extent(1) : 0.0);
    while (high - low > 1e-15 * high && 0.5 * (low + high) != low && 0.5 * (low + high) != high) {
      const double middle = 0.5 * (low + high);
      (sum_at(middle) > beyond_ * mass ? low : high) = middle;
    }
    sum_at(0.5 * (low + high));
    // By how much the sum falls with the level.
    double falls = 0.0;
    const bool radial = quantity.reading == Reading::spread;
    for (const auto& p : particles)
      falls +=
          p.mass *
          spline(((radial ? radius<double, Dim>(p) : along<double, Dim>(p, 0)) - level_) / (0.5 * cell_)) /
          (0.5 * cell_);
    const auto* channel = std::get_if<scenes::ChannelGauge>(&of.pieces.gauged);
    value_ = radial ? 2.0 * level_ : level_ - (channel ? channel->begin : 0.0);
    scale_ = (radial ? 2.0 : 1.0) / falls;
    return;
  }
  if (quantity.reading == Reading::plug_velocity)
    level_ = 0.5 * std::get<scenes::PlatesGauge>(of.pieces.gauged).height;
  if (quantity.reading == Reading::centre_height) {
    patch_ = 3.0 * cell_;
    const bool about_axis = of.settings.axisymmetric || Dim == 3;
    // Of the bump (1 - r^2 / a^2)^2 the integral over a disc is pi a^2 / 3, over both sides of a plane 16 a / 15.
    const double integral = about_axis ? std::numbers::pi * patch_ * patch_ / 3.0 : 16.0 * patch_ / 15.0;
    patch_weight_ = factor_ / integral;
  }
  if (is_mean()) {
    double weights = 0.0;
    for (const auto& p : particles) weights += weight<double, Dim>(p);
    mean_ = sum_of_terms<Dim>(particles, around) / weights;
    value_ = quantity.reading == Reading::rms_radius ? std::sqrt(mean_) : mean_;
    scale_ = (quantity.reading == Reading::rms_radius ? 0.5 / value_ : 1.0) / weights;
    return;
  }
  scale_ = 1.0;
  const double length = around.station[1] - around.station[0];
  if (quantity.reading == Reading::strand_width) {
    level_ = place_of_largest(0.5 * cell_, extent(2), 0.25 * cell_, sum_at);
    scale_ = factor_ / (length * cell_);
  } else if (quantity.reading == Reading::strand_height) {
    level_ = place_of_largest(0.0, extent(1), 0.25 * cell_, sum_at);
    scale_ = 1.0 / (length * cell_);
  } else if (quantity.reading == Reading::section_area) {
    scale_ = factor_ / length;
  }
  value_ = scale_ * sum_of_terms<Dim>(particles, around);
}

template Linearised::Linearised(const Quantity&, const Variation&,
                                const std::vector<plain::Particle<double, 2>>&, const Surroundings<double>&);
template Linearised::Linearised(const Quantity&, const Variation&,
                                const std::vector<plain::Particle<double, 3>>&, const Surroundings<double>&);

}  // namespace flowrest::mpm::derivatives
