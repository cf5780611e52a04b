#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "laws/parameters.h"
#include "mpm/derivatives/variation.h"
#include "mpm/plain/step.h"

/// What a gradient is of: readings of a run's particles with a continuous derivative.
///
/// Gauges of history.csv count particles in bins and look for the edge of a depth; particles that go from one bin
/// to the next make them jump. Here a particle fades over a cell, by integrals of the quadratic B-spline. Each
/// quantity says which column it stands for.
namespace flowrest::mpm::derivatives {

enum class Reading {
  rms_radius,
  spread,
  centre_height,
  mean_height,
  front,
  mean_velocity,
  plug_velocity,
  discharged,
  strand_width,
  strand_height,
  section_area,
  flocculation,
  kinetic_energy
};

/// A reading by its name, and for which scenes it is.
struct Quantity {
  Reading reading;
  std::string name;    ///< with the place, "smooth_strand_width_mm@0.016"
  const char* column;  ///< of history.csv that it is the smooth twin of; empty: of none
  const char* unit;
  double per_si;  ///< the unit's number for one in SI units
  const char* meaning;
  /// m along the path from where the nozzle begins: of a section that is read there and not behind the nozzle.
  std::optional<double> place = {};
};
const std::vector<Quantity>& quantities();

/// Those that a scene has.
std::vector<Quantity> quantities_of(const Variation&);
/// The quantity that a name stands for, its own or its column's; of a section with "@" and a place.
/// @throws scenes::SceneError naming those that the scene has.
Quantity quantity_named(const std::string&, const Variation&);

/// The quadratic B-spline over `x` cells, which integrates to 1, and its integral from minus infinity.
template <class T>
T spline(const T& x) {
  const T far = x < T(0) ? T(-x) : x;
  if (far < T(0.5)) return T(0.75) - far * far;
  if (!(far < T(1.5))) return T(0);
  const T left = T(1.5) - far;
  return T(0.5) * left * left;
}
template <class T>
T spline_up_to(const T& x) {
  if (!(x > T(-1.5))) return T(0);
  if (!(x < T(1.5))) return T(1);
  if (x < T(-0.5)) {
    const T in = x + T(1.5);
    return in * in * in / T(6);
  }
  if (x > T(0.5)) {
    const T left = T(1.5) - x;
    return T(1) - left * left * left / T(6);
  }
  return T(0.5) + T(0.75) * x - x * x * x / T(3);
}

/// Numbers of the moment that a reading needs beside particles, and that keys may change.
template <class T>
struct Surroundings {
  T density{};                 ///< kg/m3
  std::array<T, 2> station{};  ///< m along the strand: between them a section is read
};

/// A reading at one state, and how it changes with the state: the sum over the particles of `part`.
class Linearised {
 public:
  /// Reads `quantity` off particles at a time (s).
  template <int Dim>
  Linearised(const Quantity&, const Variation&, const std::vector<plain::Particle<double, Dim>>&,
             const Surroundings<double>&);

  /// In the quantity's unit; not a number where there is nothing to read.
  double value() const { return quantity_.per_si * value_; }

  /// What a particle adds to the reading's change: only its derivatives mean anything. In the quantity's unit.
  template <class T, int Dim>
  T part(const plain::Particle<T, Dim>& p, const Surroundings<T>& around) const {
    return T(quantity_.per_si) * own_part<T, Dim>(p, around);
  }

 private:
  template <class T, int Dim>
  T along(const plain::Particle<T, Dim>& p, std::size_t axis) const {
    return (T(p.cell[axis]) + p.place[axis]) * T(cell_);
  }
  template <class T, int Dim>
  T radius_squared(const plain::Particle<T, Dim>& p) const {
    T square(0);
    for (std::size_t a = 0; a + 1 < Dim; ++a) square += along<T, Dim>(p, a) * along<T, Dim>(p, a);
    return square;
  }
  template <class T, int Dim>
  T radius(const plain::Particle<T, Dim>& p) const {
    using std::sqrt;
    const T square = radius_squared<T, Dim>(p);
    return square > T(0) ? T(sqrt(square)) : T(0);
  }
  /// Share of a particle that is in the section.
  template <class T, int Dim>
  T in_section(const plain::Particle<T, Dim>& p, const Surroundings<T>& around) const {
    const T x = along<T, Dim>(p, 0);
    return spline_up_to(T((x - around.station[0]) / T(cell_))) -
           spline_up_to(T((x - around.station[1]) / T(cell_)));
  }
  template <class T, int Dim>
  T volume(const plain::Particle<T, Dim>& p, const Surroundings<T>& around) const {
    return p.mass * p.volume_ratio / around.density;
  }

  /// What a particle adds to the sum that a reading is made from; `level_`: of a quantile or of a row.
  template <class T, int Dim>
  T term(const plain::Particle<T, Dim>& p, const Surroundings<T>& around) const {
    const T h(cell_);
    switch (quantity_.reading) {
      case Reading::rms_radius:
        return p.mass * radius_squared<T, Dim>(p);
      case Reading::spread:
        return p.mass * spline_up_to(T((radius<T, Dim>(p) - T(level_)) / T(0.5 * cell_)));
      case Reading::front:
        return p.mass * spline_up_to(T((along<T, Dim>(p, 0) - T(level_)) / T(0.5 * cell_)));
      case Reading::centre_height:
        return volume<T, Dim>(p, around) * patch(radius_squared<T, Dim>(p));
      case Reading::mean_height:
        return p.mass * along<T, Dim>(p, Dim - 1);
      case Reading::mean_velocity:
        return p.mass * p.velocity[0];
      case Reading::plug_velocity:
        return p.mass * p.velocity[0] * spline(T((along<T, Dim>(p, 1) - T(level_)) / h));
      case Reading::discharged:
        return p.mass * spline_up_to(T(-along<T, Dim>(p, Dim - 1) / h));
      case Reading::strand_width:
        return volume<T, Dim>(p, around) * in_section<T, Dim>(p, around) *
               spline(T((along<T, Dim>(p, Dim - 1) - T(level_)) / h));
      case Reading::strand_height: {
        const T y = along<T, Dim>(p, 1);
        const T here = spline(T((y - T(level_)) / h));
        return volume<T, Dim>(p, around) * in_section<T, Dim>(p, around) *
               (factor_ > 1.0 ? T(here + spline(T((-y - T(level_)) / h))) : here);
      }
      case Reading::section_area:
        return volume<T, Dim>(p, around) * in_section<T, Dim>(p, around);
      case Reading::flocculation:
        return p.mass * p.flocculation;
      case Reading::kinetic_energy:
        break;
    }
    T square(0);
    for (const T& v : p.velocity) square += v * v;
    return T(0.5 * factor_) * p.mass * square;
  }
  /// What a sum is divided by, where it is a mean.
  template <class T, int Dim>
  T weight(const plain::Particle<T, Dim>& p) const {
    if (quantity_.reading == Reading::plug_velocity)
      return p.mass * spline(T((along<T, Dim>(p, 1) - T(level_)) / T(cell_)));
    return p.mass;
  }
  /// 1 over the integral of a bump about the axis that ends with a continuous slope, times the bump.
  template <class T>
  T patch(const T& radius_squared) const {
    const T share = T(1) - radius_squared / T(patch_ * patch_);
    return share > T(0) ? T(T(patch_weight_) * share * share) : T(0);
  }

  bool is_mean() const {
    switch (quantity_.reading) {
      case Reading::rms_radius:
      case Reading::mean_height:
      case Reading::mean_velocity:
      case Reading::plug_velocity:
      case Reading::discharged:
      case Reading::flocculation:
        return true;
      default:
        return false;
    }
  }
  bool is_quantile() const {
    return quantity_.reading == Reading::spread || quantity_.reading == Reading::front;
  }

  template <class T, int Dim>
  T own_part(const plain::Particle<T, Dim>& p, const Surroundings<T>& around) const {
    const T sum = term<T, Dim>(p, around);
    if (is_mean()) return T(scale_) * (sum - T(mean_) * weight<T, Dim>(p));
    // Of a quantile the level moves so that the share beyond it stays (implicit differentiation).
    if (is_quantile()) return T(scale_) * (sum - T(beyond_) * p.mass);
    return T(scale_) * sum;
  }

  template <int Dim>
  double sum_of_terms(const std::vector<plain::Particle<double, Dim>>& particles,
                      const Surroundings<double>& around) const {
    double sum = 0.0;
    for (const auto& p : particles) sum += term<double, Dim>(p, around);
    return sum;
  }

  Quantity quantity_;
  double cell_, factor_;
  double level_ = 0.0;                       ///< m
  double patch_ = 0.0, patch_weight_ = 0.0;  ///< m; per m2, in a plane per m
  double beyond_ = 0.005;                    ///< share of the mass beyond a quantile
  double mean_ = 0.0, scale_ = 0.0, value_ = 0.0;
};

}  // namespace flowrest::mpm::derivatives
