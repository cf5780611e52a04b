#pragma once

#include <functional>
#include <string>

#include "scenes/scene.h"

/// What a run is expected to cost, from rates that are assumptions until they are measured on the machine at
/// hand. Each solver's room tells it of its own runs.
namespace flowrest::scenes {

struct Cost {
  double memory = 0.0;       ///< bytes
  double cpu_seconds = 0.0;  ///< to time.end; less where a run stops at rest
};

/// "1.5 GB".
std::string bytes_in_words(double);

/// Mesh and steps of an OpenFOAM run: at least these steps, as the Courant number may ask for smaller ones.
struct FoamEstimate {
  double cells = 0.0;
  double steps = 0.0;
  double step = 0.0;  ///< s
  Cost cost;
};

/// What the solvers that are there tell of a run of a scene; empty where one is not built.
struct Estimates {
  std::function<Cost(const Scene&)> mpm;
  std::function<FoamEstimate(const Scene&)> foam;
};

}  // namespace flowrest::scenes
