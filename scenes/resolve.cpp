#include "scenes/resolve.h"

#include <fmt/format.h>

#include <cmath>

#include "scenes/key_types.h"

namespace flowrest::scenes {

namespace {

void resolve_runs(const Given& given, Scene& scene) {
  const bool named = given.gives("runs.mpm") || given.gives("runs.foam") || given.gives("runs.exact") ||
                     given.gives("runs.elements");
  if (!named) scene.runs.mpm = {scene.material.model};
}

/// A fault in a setting, from which nothing may be concluded any more.
void refuse(const Given& given, Draft& draft, Faults& faults, const std::string& path,
            const std::string& what) {
  faults.add(given.place_of(path), what);
  draft.unusable.insert(path);
}

/// A setting from which another one follows must not lead it out of its range.
void refuse_outside(const Given& given, Draft& draft, Faults& faults, const std::string& path,
                    const std::string& what, double number, const Range& range) {
  if (draft.unusable.contains(path) || range.holds(number)) return;
  refuse(given, draft, faults, path,
         fmt::format("{} leads to {} of {:g}; allowed: {}", path, what, number, range.text()));
}

void resolve_critical_shear_rate(const Given& given, Draft& draft, Faults& faults) {
  Material& material = draft.scene.material;
  if (given.gives("material.critical_shear_rate") || !material.regularisation_time) return;
  material.critical_shear_rate = 1.0 / *material.regularisation_time;
  refuse_outside(given, draft, faults, "material.regularisation_time", "a critical shear rate",
                 *material.critical_shear_rate, above(0.0, largest_time));
}

void resolve_moduli(const Given& given, Draft& draft, Faults& faults) {
  const bool young = given.gives("material.youngs_modulus");
  const bool bulk = given.gives("material.bulk_modulus");
  if (young && bulk) {
    refuse(given, draft, faults, "material.bulk_modulus",
           "material.bulk_modulus and material.youngs_modulus are both given; allowed: one of them, the "
           "other follows "
           "from the Poisson ratio");
  } else if (!young && !bulk) {
    refuse(given, draft, faults, "material.youngs_modulus",
           "material.youngs_modulus is missing; needed: youngs_modulus or bulk_modulus (Pa)");
  } else if (draft.bulk_modulus) {
    Material& material = draft.scene.material;
    material.youngs_modulus = 3.0 * *draft.bulk_modulus * (1.0 - 2.0 * material.poisson_ratio);
    refuse_outside(given, draft, faults, "material.bulk_modulus", "a Young's modulus",
                   material.youngs_modulus, above(0.0, largest_stress));
  }
}

/// The whole number whose `power`-th power is `number`, or 0.
int exact_root(int number, int power) {
  const int root = static_cast<int>(std::lround(std::pow(number, 1.0 / power)));
  return static_cast<int>(std::lround(std::pow(root, power))) == number ? root : 0;
}

/// A number is a square or a cube, and its root is the number along each axis whatever the dimension: so a
/// scene that says 9 for 2D keeps its spacing, with 27 a cell, when it is run in 3D.
int along_each_axis(int number, int dimension) {
  const int other_dimension = dimension == 2 ? 3 : 2;
  const int root = exact_root(number, dimension);
  return root ? root : exact_root(number, other_dimension);
}

void resolve_particles(const Given& given, Draft& draft, Faults& faults) {
  const std::string path = "mpm.particles_per_cell";
  if (draft.unusable.contains(path) || draft.unusable.contains("geometry.dimension")) return;
  const int dimension = draft.scene.spatial_dimension();
  std::vector<int>& axes = draft.scene.mpm.particles_per_cell;
  if (!given.gives(path)) {
    constexpr int default_along_an_axis = 3;
    axes.assign(dimension, default_along_an_axis);
  } else if (draft.particles_for_each_axis) {
    axes = draft.particles_per_cell;
    if (std::ssize(axes) == dimension) return;
    refuse(given, draft, faults, path,
           fmt::format("{} has {} entries; allowed: {}, one for each axis of a computation that is {}", path,
                       axes.size(), dimension, to_string(draft.scene.geometry.dimension)));
  } else if (const int root = along_each_axis(draft.particles_per_cell.front(), dimension)) {
    axes.assign(dimension, root);
    if (root <= most_particles_along_an_axis) return;
    refuse(given, draft, faults, path,
           fmt::format("{} is {}, {} along each axis; allowed: at most {} along an axis", path,
                       draft.particles_per_cell.front(), root, most_particles_along_an_axis));
  } else {
    const int number = draft.particles_per_cell.front();
    const double near = std::round(std::pow(number, 1.0 / dimension));
    refuse(given, draft, faults, path,
           fmt::format(
               "{} is {}, neither a square nor a cube; allowed: for example {:g}, or an array with one entry "
               "for each axis",
               path, number, std::pow(near, dimension)));
  }
}

void resolve_gauges(const Given& given, Scene& scene) {
  const Gauges of_body = gauges_of_body(scene);
  for (const auto& [name, gauge] : gauge_settings)
    if (!given.gives(std::string("gauges.") + name)) scene.gauges.*gauge = of_body.*gauge;
}

}  // namespace

void resolve(const Given& given, Draft& draft, Faults& faults) {
  constexpr double step_of_paper = 5e-4;  // s, Yu et al. 2026, section 4.1.1
  Scene& scene = draft.scene;
  resolve_runs(given, scene);
  resolve_moduli(given, draft, faults);
  resolve_particles(given, draft, faults);
  resolve_critical_shear_rate(given, draft, faults);
  if (scene.mpm.scheme == Scheme::paper && !scene.mpm.time_step) scene.mpm.time_step = step_of_paper;
  resolve_gauges(given, scene);
  if (!given.gives("foam.cell")) scene.foam.cell = scene.mpm.cell;
}

}  // namespace flowrest::scenes
