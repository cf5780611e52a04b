#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "scenes/scene.h"

/// Scenes that tests start from and spoil.
namespace flowrest::scenes::test {

/// A slump with every section; line numbers matter to the tests of messages.
inline const std::string slump_text = R"(title = "A slump"
kind = "slump"
runs = { mpm = ["elasto-viscoplastic"], foam = ["papanastasiou"], exact = true }
[geometry]
dimension = "axisymmetric"
cone_height = 0.3
cone_radius_top = 0.05
cone_radius_bottom = 0.1
domain_radius = 0.45
domain_height = 0.35
[material]
model = "elasto-viscoplastic"
density = 2300.0
yield_stress = 50
plastic_viscosity = 50.0
youngs_modulus = 1.0e5
poisson_ratio = 0.3
regularisation_time = 100.0
[walls]
base = "no-slip"
[forces]
gravity = 9.81
[time]
end = 60.0
stop_at_rest = true
rest_bound = 0.006
[output]
history_interval = 0.05
profile_interval = 0.25
snapshot_interval = 1.0
checkpoint_interval = 5.0
[mpm]
scheme = "quadratic-apic"
cell = 0.01
particles_per_cell = 9
cfl = 0.75
[foam]
cell = 0.01
)";

/// A duct with no more than it needs.
inline const std::string duct_text = R"(title = "A duct"
kind = "duct"
[geometry]
height = 0.5
[material]
density = 2000
yield_stress = 100
plastic_viscosity = 30
bulk_modulus = 0.33e6
poisson_ratio = 0.45
[forces]
body_force = [[0.0, 2000.0], [12.0, 360.0]]
[time]
end = 20
[mpm]
cell = 0.01
)";

/// The text with its only occurrence of `from` replaced.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto place = text.find(from);
  EXPECT_NE(place, std::string::npos) << from;
  EXPECT_EQ(text.find(from, place + 1), std::string::npos) << from << " is not unique";
  return place == std::string::npos ? text : text.replace(place, from.size(), to);
}

/// What the reader says against a scene; empty where it takes it.
inline std::string complaint(const std::string& text, const Overrides& overrides = {}) {
  try {
    parse_scene(text, "wrong.toml", overrides);
  } catch (const SceneError& error) {
    return error.what();
  }
  return {};
}

}  // namespace flowrest::scenes::test
