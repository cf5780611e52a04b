#include "scenes/resolve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/check.h"
#include "scenes/names.h"

namespace flowrest::scenes {

namespace {

bool gives(const Given& given, const std::string& path) { return given.values.contains(path); }

void resolve_runs(const Given& given, Scene& scene) {
  const bool named = gives(given, "runs.mpm") || gives(given, "runs.foam") || gives(given, "runs.exact");
  if (!named) scene.runs.mpm = {scene.material.model};
}

void resolve_moduli(const Given& given, Draft& draft, Faults& faults) {
  const bool young = gives(given, "material.youngs_modulus");
  if (young && draft.bulk_modulus) {
    faults.add(
        place_of("material.bulk_modulus", given),
        "material.bulk_modulus and material.youngs_modulus are both given; allowed: one of them, the other "
        "follows from the Poisson ratio");
  } else if (!young && !draft.bulk_modulus) {
    faults.add(place_of("material.youngs_modulus", given),
               "material.youngs_modulus is missing; needed: youngs_modulus or bulk_modulus (Pa)");
  } else if (draft.bulk_modulus) {
    Material& material = draft.scene.material;
    material.youngs_modulus = 3.0 * *draft.bulk_modulus * (1.0 - 2.0 * material.poisson_ratio);
  }
}

/// The whole number whose `power`-th power is `number`, or 0.
int exact_root(int number, int power) {
  const int root = static_cast<int>(std::lround(std::pow(number, 1.0 / power)));
  return static_cast<int>(std::lround(std::pow(root, power))) == number ? root : 0;
}

/// A number is a square or a cube, and its root is the number along each axis whatever the dimension: so a
/// scene that says 9 for 2D keeps its spacing, with 27 a cell, when it is run in 3D.
void resolve_particles(const Given& given, Draft& draft, Faults& faults) {
  constexpr int default_along_an_axis = 3;
  const int dimension = draft.scene.spatial_dimension();
  std::vector<int>& axes = draft.scene.mpm.particles_per_cell;
  const Location where = place_of("mpm.particles_per_cell", given);
  if (!gives(given, "mpm.particles_per_cell")) {
    axes.assign(dimension, default_along_an_axis);
  } else if (draft.particles_for_each_axis) {
    axes = draft.particles_per_cell;
    if (std::ssize(axes) == dimension) return;
    faults.add(
        where,
        fmt::format("mpm.particles_per_cell has {} entries; allowed: {}, one for each axis of a {} scene",
                    axes.size(), dimension, to_string(draft.scene.geometry.dimension)));
  } else {
    const int number = draft.particles_per_cell.front();
    const int own = exact_root(number, dimension);
    const int root = own ? own : exact_root(number, 5 - dimension);
    if (root) {
      axes.assign(dimension, root);
      return;
    }
    const int near = static_cast<int>(std::max(1L, std::lround(std::pow(number, 1.0 / dimension))));
    faults.add(where,
               fmt::format("mpm.particles_per_cell is {}, which is neither a square nor a cube; allowed: for "
                           "example {}, or an array with one entry for each axis",
                           number, std::lround(std::pow(near, dimension))));
  }
}

}  // namespace

void resolve(const Given& given, Draft& draft, Faults& faults) {
  constexpr double step_of_paper = 5e-4;  // s, Yu et al. 2026, section 4.1.1
  Scene& scene = draft.scene;
  resolve_runs(given, scene);
  resolve_moduli(given, draft, faults);
  resolve_particles(given, draft, faults);
  if (!scene.material.critical_shear_rate && scene.material.regularisation_time) {
    scene.material.critical_shear_rate = 1.0 / *scene.material.regularisation_time;
  }
  if (scene.mpm.scheme == Scheme::paper && !scene.mpm.time_step) scene.mpm.time_step = step_of_paper;
  if (!gives(given, "foam.cell")) scene.foam.cell = scene.mpm.cell;
}

}  // namespace flowrest::scenes
