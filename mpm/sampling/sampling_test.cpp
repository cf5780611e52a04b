#include "mpm/sampling/sampling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "mpm/solver/settings.h"
#include "runs/process.h"

using namespace flowrest;
using namespace flowrest::mpm;

namespace {

scenes::Scene slump(const std::string& dimension, const std::vector<std::string>& more = {}) {
  std::vector<std::string> set = {"geometry.dimension=" + dimension};
  set.insert(set.end(), more.begin(), more.end());
  return scenes::load_scene("roussel-slump", {set, {}});
}

double total(const std::vector<Seed>& seeds) {
  double sum = 0.0;
  for (const auto& s : seeds) sum += s.volume;
  return sum;
}

std::array<double, 3> place(const Seed& s, double cell) {
  std::array<double, 3> x{};
  for (std::size_t a = 0; a < 3; ++a) x[a] = (s.cell[a] + s.position[a]) * cell;
  return x;
}

bool same_places(const std::vector<Seed>& a, const std::vector<Seed>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i].cell != b[i].cell || a[i].position != b[i].position) return false;
  return true;
}

const std::vector<std::string> dimensions = {"axisymmetric", "plane", "quarter", "full"};
const std::string jittered = "mpm.seeding=jittered", eight = "mpm.particles_per_cell=8";

std::vector<std::string> eight_where_3d(const std::string& dimension) {
  if (dimension == "quarter" || dimension == "full") return {eight};
  return {};
}

}  // namespace

TEST(Sampling, VolumesSumToTheBodysOwn) {
  for (const auto& dimension : dimensions) {
    const auto scene = slump(dimension, eight_where_3d(dimension));
    const double cone = std::numbers::pi / 3.0 * 0.3 * (0.05 * 0.05 + 0.05 * 0.1 + 0.1 * 0.1);
    const double whole = dimension == "plane" ? (0.05 + 0.1) * 0.3 : cone;
    EXPECT_NEAR(total(seed_particles(scene)) * whole_body_factor(scene), whole, 1e-11 * whole) << dimension;
  }
}

TEST(Sampling, EveryParticleLiesInsideTheCone) {
  for (const auto& dimension : dimensions)
    for (const bool jitter : {false, true}) {
      auto more = eight_where_3d(dimension);
      if (jitter) more.push_back(jittered);
      const auto scene = slump(dimension, more);
      const int up = scene.spatial_dimension() - 1;
      double lowest_x = 1.0;
      for (const auto& seed : seed_particles(scene)) {
        for (std::size_t a = 0; a < 3; ++a) {
          ASSERT_GE(seed.position[a], 0.0);
          ASSERT_LT(seed.position[a], 1.0);
        }
        const auto x = place(seed, 0.01);
        const double height = x[static_cast<std::size_t>(up)],
                     radius = up == 2 ? std::hypot(x[0], x[1]) : std::abs(x[0]);
        ASSERT_GE(height, 0.0) << dimension;
        ASSERT_LE(height, 0.3) << dimension;
        ASSERT_LE(radius, 0.1 - 0.05 * height / 0.3 + 1e-12) << dimension;
        ASSERT_GT(seed.volume, 0.0) << dimension;
        if (dimension != "full") {
          ASSERT_GE(x[0], 0.0) << dimension;
        }
        lowest_x = std::min(lowest_x, x[0]);
      }
      EXPECT_EQ(lowest_x < 0.0, dimension == "full") << dimension;
    }
}

TEST(Sampling, InnerCellsHoldTheAskedNumberOfParticles) {
  const auto count_inside = [](const scenes::Scene& scene) {
    std::map<CellIndex, int> count;
    for (const auto& s : seed_particles(scene)) ++count[s.cell];
    return count;
  };
  const auto square = count_inside(slump("axisymmetric"));
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 25; ++j) EXPECT_EQ(square.at({i, j, 0}), 9) << i << ", " << j;
  const auto uneven = count_inside(slump("axisymmetric", {"mpm.particles_per_cell=[4, 1]"}));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(uneven.at({i, 3, 0}), 4);
  const auto cube = count_inside(slump("quarter", {eight}));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(cube.at({i, i, 2}), 8);
  const auto duct = count_inside(scenes::load_scene("poiseuille-step-down"));
  EXPECT_EQ(duct.size(), 4u * 50u);
  for (const auto& [cell, n] : duct) EXPECT_EQ(n, 16);
}

TEST(Sampling, ALatticeOfADuctIsEvenAndFillsIt) {
  const auto scene = scenes::load_scene("poiseuille-step-down");
  const auto seeds = seed_particles(scene);
  const double share = std::pow(0.01 / 4.0, 2);
  std::set<double> heights;
  for (const auto& s : seeds) {
    EXPECT_NEAR(s.volume, share, 1e-12 * share);
    heights.insert(std::round(place(s, 0.01)[1] * 1e9));
  }
  EXPECT_EQ(heights.size(), 200u);
  EXPECT_NEAR(total(seeds), 0.04 * 0.5, 1e-14);
}

TEST(Sampling, JitterIsReproducibleAndFollowsItsSeed) {
  const auto one = seed_particles(slump("axisymmetric", {jittered, "mpm.seed=1"}));
  EXPECT_TRUE(same_places(one, seed_particles(slump("axisymmetric", {jittered, "mpm.seed=1"}))));
  EXPECT_FALSE(same_places(one, seed_particles(slump("axisymmetric", {jittered, "mpm.seed=2"}))));
  EXPECT_FALSE(same_places(one, seed_particles(slump("axisymmetric"))));
  // One in each lattice site: as even as the lattice, on the scale of a site.
  std::set<std::array<int, 4>> sites;
  for (const auto& s : one)
    sites.insert(
        {s.cell[0], s.cell[1], static_cast<int>(s.position[0] * 3.0), static_cast<int>(s.position[1] * 3.0)});
  EXPECT_EQ(sites.size(), one.size());
}

TEST(Sampling, AxisymmetricParticlesStandForRings) {
  const auto scene = slump("axisymmetric");
  for (const auto& s : seed_particles(scene)) {
    if (s.cell[0] >= 4 || s.cell[1] >= 25) continue;  // whole sites
    const double radius = place(s, 0.01)[0], ring = 2.0 * std::numbers::pi * radius * std::pow(0.01 / 3.0, 2);
    ASSERT_NEAR(s.volume, ring, 2e-3 * ring) << "at radius " << radius;
  }
}

TEST(Sampling, AQuarterIsAQuarterOfTheFullCone) {
  const auto full = seed_particles(slump("full", {eight})),
             quarter = seed_particles(slump("quarter", {eight}));
  EXPECT_EQ(full.size(), 4 * quarter.size());
  std::array<double, 3> centre{};
  for (const auto& s : full)
    for (std::size_t a = 0; a < 3; ++a) centre[a] += s.volume * place(s, 0.01)[a];
  EXPECT_NEAR(centre[0], 0.0, 1e-15);
  EXPECT_NEAR(centre[1], 0.0, 1e-15);
  double height = 0.0;
  for (const auto& s : quarter) height += s.volume * place(s, 0.01)[2];
  EXPECT_NEAR(centre[2], 4.0 * height, 1e-12 * centre[2]);
  // Centroid of the frustum, to what sites cut by the flank leave.
  const double r = 0.05, b = 0.1,
               exact = 0.3 / 4.0 * (b * b + 2 * b * r + 3 * r * r) / (b * b + b * r + r * r);
  EXPECT_NEAR(centre[2] / total(full), exact, 2e-3 * exact);
}

TEST(Sampling, ContainersAreFilledToTheirVolumesWithinTheirWalls) {
  for (const std::string name : {"mix-a-lbox-sf0", "mix-a-vfunnel-sf0", "dam-break", "mix-a-slump-sf0"})
    for (const std::string dimension : {"plane", "full", "half", "quarter", "axisymmetric"}) {
      std::optional<scenes::Scene> scene;
      try {
        scene = scenes::load_scene(name, {{"geometry.dimension=" + dimension}, {}});
      } catch (const scenes::SceneError&) {
        continue;  // not one of the apparatus' own
      }
      const double cell = cell_size(*scene);
      const auto walls = settings_of(*scene).walls;
      double filled = 0.0;
      for (const Seed& s : seed_particles(*scene)) {
        filled += s.volume * s.volume_ratio;
        for (const Wall& wall : walls)
          ASSERT_GE(wall.distance(place(s, cell), 0.0), -1e-9) << name << wall.name;
      }
      double volume = 0.0;
      const bool plane = dimension == "plane";
      if (name == "mix-a-lbox-sf0") volume = plane ? 0.1 * 0.6 : 0.012;
      if (name == "mix-a-vfunnel-sf0") volume = scene->v_funnel().volume() / (plane ? 0.075 : 1.0);
      if (name == "dam-break") volume = plane ? 0.36 : 0.36 * 0.15;
      if (name == "mix-a-slump-sf0") volume = plane ? 0.15 * 0.3 : scene->slump().volume();
      // A column's top sinks under its own weight, by less than what its foot's pressure would press it.
      const bool settled = name == "mix-a-lbox-sf0";
      EXPECT_NEAR(filled * whole_body_factor(*scene), volume, settled ? 0.04 * volume : 1e-9 * volume)
          << name << " " << dimension;
    }
}

TEST(Sampling, ConcreteInAContainerCarriesItsWeightFromTheStart) {
  const auto scene = scenes::load_scene("mix-a-lbox-sf0", {{"geometry.dimension=plane"}, {}});
  const auto settings = settings_of(scene);
  const auto seeds = seed_particles(scene);
  double volume = 0.0, top = 0.0;
  for (const Seed& s : seeds) {
    volume += s.volume;
    top = std::max(top, place(s, 0.01)[1]);
  }
  EXPECT_NEAR(volume, 0.06, 1e-4 * 0.06);  // 12 litres for the whole width, without pressure
  EXPECT_LT(top, 0.595);
  for (const Seed& s : seeds) {
    // Its pressure bears the material above: the weight of what lies over it, to a few parts in a thousand.
    const double pressure = settings.state.pressure(s.volume_ratio);
    double above = 0.0;
    for (const Seed& t : seeds) {
      if (place(t, 0.01)[1] > place(s, 0.01)[1]) above += t.volume;
      if (place(t, 0.01)[1] == place(s, 0.01)[1]) above += 0.5 * t.volume;
    }
    ASSERT_NEAR(pressure, above / 0.1 * 2400.0 * 9.81, 0.005 * 14000.0);
    if (s.cell[0] > 0) break;
  }
}

TEST(Sampling, FlocculationBeginsAsTheSceneSays) {
  const auto scene = slump("axisymmetric",
                           {"thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
                            "thixotropy.initial_flocculation=1.8"});
  for (const auto& s : seed_particles(scene)) ASSERT_EQ(s.flocculation, 1.8);
  for (const auto& s : seed_particles(slump("axisymmetric"))) ASSERT_EQ(s.flocculation, 0.0);
}

TEST(Sampling, AnUnstructuredMeshFillsEveryBodyWithParticlesOfUnequalVolume) {
  if (!runs::find_program("gmsh")) GTEST_SKIP() << "gmsh is not installed";
  const std::string unstructured = "mpm.seeding=gmsh";
  for (const auto& [name, dimension] : {std::pair{"roussel-slump", "axisymmetric"},
                                        {"roussel-slump", "plane"},
                                        {"roussel-slump", "quarter"},
                                        {"roussel-slump", "full"},
                                        {"mix-a-vfunnel-sf0", "quarter"},
                                        {"mix-a-vfunnel-sf0", "plane"},
                                        {"mix-a-lbox-sf0", "half"},
                                        {"dam-break", "plane"},
                                        {"poiseuille-step-down", "plane"}}) {
    const std::string of = std::string(name) + " " + dimension;
    const auto of_scene = [&, name = name, dimension = dimension](const std::vector<std::string>& more) {
      std::vector<std::string> set = {"geometry.dimension=" + std::string(dimension),
                                      "mpm.particles_per_cell=8"};
      if (std::string(dimension) == "axisymmetric" || std::string(dimension) == "plane")
        set.back() = "mpm.particles_per_cell=4";
      set.insert(set.end(), more.begin(), more.end());
      if (std::string(name) != "poiseuille-step-down") set.push_back("mpm.cell=0.03");
      return scenes::load_scene(name, {set, {}});
    };
    const auto lattice = seed_particles(of_scene({})), mesh = seed_particles(of_scene({unstructured}));
    EXPECT_NEAR(total(mesh), total(lattice), 2e-3 * total(lattice)) << of;
    EXPECT_NEAR(static_cast<double>(mesh.size()), static_cast<double>(lattice.size()),
                0.3 * static_cast<double>(lattice.size()))
        << of;
    std::array<double, 3> centre{}, expected{};
    double least = 1e9, most = 0.0;
    for (const auto& s : mesh) {
      for (std::size_t a = 0; a < 3; ++a) {
        ASSERT_GE(s.position[a], 0.0);
        ASSERT_LT(s.position[a], 1.0);
        centre[a] += s.volume * place(s, 1.0)[a] / total(mesh);
      }
      least = std::min(least, s.volume);
      most = std::max(most, s.volume);
    }
    for (const auto& s : lattice)
      for (std::size_t a = 0; a < 3; ++a) expected[a] += s.volume * place(s, 1.0)[a] / total(lattice);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(centre[a], expected[a], 0.05) << "cells, " << of;
    EXPECT_GT(most, 1.5 * least) << of;
  }
}
