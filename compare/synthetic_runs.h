#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runs/run_directory.h"

/// Runs made up by formula, for the tests of the comparison: what they must measure is known.
namespace flowrest::compare::synthetic {

/// A slump whose depth is H sqrt(1 - r/R), with the cone's volume, and whose radius approaches `radius` while
/// it creeps.
struct Slump {
  std::string solver = "mpm";
  scenes::Model model = scenes::Model::elasto_viscoplastic;
  double size = 1.0;  ///< of its lengths; its times and speeds go with the root. What follows is of size 1.
  double radius = 0.288;  ///< m, approached
  double rate = 0.4;      ///< s: R = radius - (radius - 0.1)/(1 + t/rate)^2 + creep t/2
  double creep = 0.0;     ///< m/s, of the spread
  double noise = 0.0;     ///< m, amplitude of a ripple on the spread
  double end = 60.0;      ///< s
  double cell = 0.010;    ///< m, of the rings
  runs::Status status = runs::Status::end_time;
  std::string reason;
  std::string verdict = "sound";
  double cpu = 12.0;             ///< s
  std::vector<std::string> set;  ///< overrides of the scene: "mpm.cell=0.005"

  double radius_at(double time) const;
};
void write(const Slump&, const std::filesystem::path& directory);

/// A duct that follows the exact steady profile up to the step down, then decays at 1/`decay` to `creep`
/// times its shape.
struct Duct {
  scenes::Model model = scenes::Model::elasto_viscoplastic;
  double decay = 1.0;       ///< s
  double creep = 0.0;       ///< m/s, plug velocity left over
  bool from_plate = false;  ///< y counted from the lower plate
};
void write(const Duct&, const std::filesystem::path& directory);

/// An L-box whose front comes up to `front` as 1 - exp(-t), a wedge behind it; flocs break and grow again by
/// `recovery`.
struct Box {
  scenes::Model model = scenes::Model::elasto_viscoplastic;
  double front = 0.520;    ///< m from the gate, approached; ends at the end wall
  double recovery = 0.02;  ///< 1/s, of the flocculation state from 2 s on
  double end = 10.0;       ///< s
  runs::Status status = runs::Status::end_time;
  std::string walls_differ;
  std::vector<std::string> set;
};
void write(const Box&, const std::filesystem::path& directory);

/// A funnel that discharges evenly until it is empty after `empty` seconds; its sight clears as fast.
struct Funnel {
  scenes::Model model = scenes::Model::elasto_viscoplastic;
  double empty = 2.0;  ///< s
  std::vector<std::string> set;
};
void write(const Funnel&, const std::filesystem::path& directory);

}  // namespace flowrest::compare::synthetic
