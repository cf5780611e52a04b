// What one solver leaves another starts from: what is handed over is kept, and reads the same.
#include "foamCases/hand_over.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "compare/apparatus/arrested_slump.h"
#include "foamCases/case_filler.h"
#include "foamCases/field_file.h"
#include "foamCases/plug_in.h"
#include "foamCases/quarter_grid.h"
#include "foamCases/slump_mesh.h"
#include "foamCases/wedge_grid.h"
#include "mpm/output/hand_over.h"
#include "mpm/output/run.h"
#include "mpm/solver/settings.h"
#include "runs/depth.h"
#include "runs/errors.h"
#include "runs/run_directory.h"
#include "runs/temporary_folder.h"
#include "scenes/pieces.h"

using namespace flowrest;
namespace fs = std::filesystem;
using runs::DepthColumns;
using runs::MaterialState;
using testing::AllOf;
using testing::HasSubstr;

namespace {

scenes::Scene slump(const std::vector<std::string>& more = {}) {
  std::vector<std::string> set = {"mpm.cell=0.02", "mpm.threads=1", "time.end=3",
                                  "output.history_interval=0.05", "output.snapshot_interval=0.5"};
  set.insert(set.end(), more.begin(), more.end());
  return scenes::load_scene("roussel-slump", {set, {}});
}

std::vector<std::string> thixotropic(std::vector<std::string> more = {}) {
  more.insert(more.end(), {"thixotropy.flocculation_rate=0.39", "thixotropy.deflocculation_coefficient=0.15",
                           "thixotropy.initial_flocculation=1.8"});
  return more;
}

double body_volume(const scenes::Scene& scene) {
  const auto pieces = scenes::pieces_of(scene);
  double volume = 0.0;
  for (const auto& body : pieces.bodies) volume += pieces.whole_over_computed * body.volume;
  return volume;
}

/// A heap h = sqrt(c (R - r)) of the scene's volume, cut at random into parcels that move, are stressed and
/// flocculated at random.
MaterialState random_heap(const scenes::Scene& scene, unsigned seed, double reach) {
  std::mt19937 random(seed);
  const auto between = [&](double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>()(random);
  };
  MaterialState state;
  state.from = "a heap";
  state.kind = "slump";
  state.dimension = scene.geometry.dimension;
  state.time = 1.0;
  state.density = scene.material.density;
  state.flocculates = true;
  const bool in_space = state.dimension == scenes::Dimension::quarter;
  auto& columns = state.columns;
  columns.plan = in_space                                      ? DepthColumns::Plan::squares
                 : state.dimension == scenes::Dimension::plane ? DepthColumns::Plan::strips
                                                               : DepthColumns::Plan::rings;
  columns.width = 0.01;
  columns.along_x = static_cast<int>(std::ceil(reach / columns.width)) + 1;
  columns.along_y = in_space ? columns.along_x : 1;
  double held = 0.0;
  for (int j = 0; j < columns.along_y; ++j)
    for (int i = 0; i < columns.along_x; ++i) {
      const double r = columns.width * std::hypot(i + 0.5, in_space ? j + 0.5 : 0.0);
      columns.depth.push_back(std::sqrt(std::max(0.0, reach - r)));
      held +=
          columns.depth.back() * DepthColumns::area(columns.plan, i * columns.width, (i + 1) * columns.width,
                                                    j * columns.width, (j + 1) * columns.width);
    }
  const double scale = body_volume(scene) / held;
  for (int j = 0; j < columns.along_y; ++j)
    for (int i = 0; i < columns.along_x; ++i) {
      double& depth = columns.depth[static_cast<std::size_t>(i + columns.along_x * j)];
      depth *= scale;
      const double west = i * columns.width, south = in_space ? j * columns.width : 0.0;
      for (double low = 0.0; low < depth;) {
        const double high = std::min(depth, low + between(0.2, 1.0) * columns.width);
        runs::Parcel p;
        p.low = {west, south, low};
        p.high = {west + columns.width, in_space ? south + columns.width : 0.0, high};
        p.volume = (high - low) *
                   DepthColumns::area(columns.plan, west, west + columns.width, south, south + columns.width);
        p.velocity = {between(-0.1, 0.3), in_space ? between(-0.1, 0.3) : 0.0, between(-0.3, 0.1)};
        for (double& s : p.stress) s = between(-50.0, 50.0);
        p.stress[5] = -p.stress[0] - p.stress[3];
        p.flocculation = between(0.0, 2.0);
        state.parcels.push_back(p);
        low = high;
      }
    }
  return state;
}

/// Sums over what a receiver holds, of the whole body.
struct Sums {
  double volume = 0.0, flocculation = 0.0;
  std::array<double, 3> momentum{};
  void add(double v, const std::array<double, 3>& velocity, double lambda, double density) {
    volume += v;
    flocculation += v * lambda;
    for (std::size_t a = 0; a < 3; ++a) momentum[a] += density * v * velocity[a];
  }
};

void expect_kept(const MaterialState& state, const Sums& sums) {
  EXPECT_NEAR(sums.volume, state.volume(), 1e-10 * state.volume());
  EXPECT_NEAR(sums.flocculation / sums.volume, state.flocculation(), 1e-6 * state.flocculation());
  const auto momentum = state.momentum();
  for (std::size_t a = 0; a < 3; ++a)
    EXPECT_NEAR(sums.momentum[a], momentum[a], 1e-6 * std::hypot(momentum[0], momentum[1], momentum[2])) << a;
}

Sums sums_of(const scenes::Scene& scene, const std::vector<mpm::Seed>& seeds) {
  Sums sums;
  const double factor = scenes::pieces_of(scene).whole_over_computed;
  const bool section = scene.spatial_dimension() == 2;
  for (const auto& s : seeds)
    sums.add(factor * s.volume, section ? std::array{s.velocity[0], 0.0, s.velocity[1]} : s.velocity,
             s.flocculation, scene.material.density);
  return sums;
}

/// The spread of particles as the solver's gauge reads it, m.
double spread_of(const scenes::Scene& scene, const std::vector<mpm::Seed>& seeds) {
  const double cell = mpm::cell_size(scene), grain = cell / scene.mpm.particles_per_cell.front();
  const bool plane = scene.geometry.dimension == scenes::Dimension::plane;
  runs::DepthAccumulator depth(plane ? runs::About::plane : runs::About::axis, cell, 1.0, grain);
  const double factor = plane ? 1.0 : scenes::pieces_of(scene).whole_over_computed;
  for (const auto& s : seeds) {
    const double x = (s.cell[0] + s.position[0]) * cell, y = (s.cell[1] + s.position[1]) * cell;
    depth.add(scene.spatial_dimension() == 3 ? std::hypot(x, y) : x, factor * s.volume * s.volume_ratio);
  }
  return runs::spread({depth.centres(), depth.depth(), plane ? runs::About::plane : runs::About::axis},
                      scene.gauges.spread_depth);
}

/// The spread of a state over its own rings or strips.
double spread_of(const scenes::Scene& scene, const MaterialState& state) {
  std::vector<double> centre;
  for (int i = 0; i < state.columns.along_x; ++i) centre.push_back((i + 0.5) * state.columns.width);
  const bool plane = state.columns.plan == DepthColumns::Plan::strips;
  return runs::spread({centre, state.columns.depth, plane ? runs::About::plane : runs::About::axis},
                      scene.gauges.spread_depth);
}

/// A case's initial fields, read back from the folder that a state was written into.
struct CaseState {
  CaseState(const scenes::Scene& given, const MaterialState& state, const fs::path& folder) : scene(given) {
    foam::fill_case(scene, folder, foam::plug_in_for(scene));
    foam::write_state(scene, state, folder);
    const fs::path time = folder / foam::folder_of_time(state.time);
    const std::size_t cells = foam::slump_mesh(scene)->cells();
    fields.fraction = foam::read_internal_field(time / "alpha.concrete", cells, 1);
    fields.velocity = foam::read_internal_field(time / "U", cells, 3);
    if (fs::exists(time / "flocculation"))
      fields.structure = foam::read_internal_field(time / "flocculation", cells, 1);
    if (fs::exists(time / "stress")) stress = foam::read_internal_field(time / "stress", cells, 6);
    gauges = foam::slump_mesh(scene)->gauge(fields, scene.material.density, false);
  }
  double volume_of(std::size_t cell) const {
    if (scene.geometry.dimension == scenes::Dimension::quarter) {
      const auto grid = foam::quarter_grid(scene);
      return grid.cell_volume(static_cast<int>(cell / grid.columns()));
    }
    const auto grid = foam::wedge_grid(scene);
    const auto rings = static_cast<std::size_t>(grid.rings);
    return grid.cell_volume(static_cast<int>(cell % rings), static_cast<int>(cell / rings));
  }
  Sums sums() const {
    Sums sums;
    for (std::size_t c = 0; c < fields.fraction.size(); ++c)
      sums.add(fields.fraction[c] * volume_of(c),
               {fields.velocity[3 * c], fields.velocity[3 * c + 1], fields.velocity[3 * c + 2]},
               fields.structure.empty() ? 0.0 : fields.structure[c], scene.material.density);
    return sums;
  }
  double spread() const { return runs::spread(gauges.profile(), scene.gauges.spread_depth); }

  scenes::Scene scene;
  foam::SlumpFields fields;
  std::vector<double> stress;
  foam::SlumpGauges gauges;
};

std::string refusal(const std::function<void()>& what) {
  try {
    what();
  } catch (const runs::RunError& error) {
    return error.what();
  }
  return "accepted";
}

class HandOver : public testing::Test {
 protected:
  /// Runs a scene in MPM, from a state where one is named.
  runs::Run run_mpm(const scenes::Scene& scene, const std::string& name, const std::string& from = "") {
    mpm::RunOptions options;
    options.directory = folder / name;
    options.quiet = true;
    options.from = from;
    options.read_state = [](const std::string& asked, const scenes::Scene& own) {
      return asked.starts_with("exact/") ? compare::exact::arrested_state(asked, own)
                                         : mpm::read_state(asked);
    };
    mpm::run(scene, options);
    return runs::read_run(options.directory);
  }
  std::string at(const std::string& name, double time) const {
    return fmt::format("{}@{}", (folder / name).string(), time);
  }

  runs::TemporaryFolder temporary;
  fs::path folder = temporary.path();
};

double spread_at(const runs::Run& run, double time) {
  const auto& times = run.history.at("time_s");
  for (std::size_t i = 0; i < times.size(); ++i)
    if (std::abs(times[i] - time) < 1e-9) return run.history.at("spread_mm")[i];
  return runs::nothing;
}

}  // namespace

class HandOverOfHeaps : public testing::TestWithParam<std::string> {
 protected:
  scenes::Scene scene(double cell) const {
    return slump(
        thixotropic({"geometry.dimension=" + GetParam(), "mpm.cell=" + std::to_string(cell),
                     "foam.cell=" + std::to_string(cell), "foam.base_rows=4",
                     GetParam() == "quarter" ? "mpm.particles_per_cell=8" : "mpm.particles_per_cell=9"}));
  }
  double reach() const { return GetParam() == "plane" ? 0.41 : 0.27; }
};

TEST_P(HandOverOfHeaps, KeepsVolumeMomentumAndFlocculationInParticlesOfAnyCell) {
  for (const double cell : {0.02, 0.013, 0.008})
    for (unsigned seed = 1; seed < 4; ++seed) {
      const auto target = scene(cell);
      const MaterialState state = random_heap(target, seed, reach());
      expect_kept(state, sums_of(target, mpm::seeds_of_state(target, state)));
    }
}

TEST_P(HandOverOfHeaps, KeepsVolumeMomentumAndFlocculationInCellsOfAnySize) {
  if (GetParam() == "plane") GTEST_SKIP() << "OpenFOAM has no plane slump";
  for (const double cell : {0.02, 0.013, 0.008}) {
    const runs::TemporaryFolder folder;
    const auto target = scene(cell);
    const MaterialState state = random_heap(target, 7, reach());
    expect_kept(state, CaseState(target, state, folder.path()).sums());
  }
}

TEST_P(HandOverOfHeaps, LeavesNoCellMoreThanFullAndNoAirUnderConcrete) {
  if (GetParam() == "plane") GTEST_SKIP() << "OpenFOAM has no plane slump";
  const runs::TemporaryFolder folder;
  const auto target = scene(0.013);
  const CaseState made(target, random_heap(target, 3, reach()), folder.path());
  for (const double f : made.fields.fraction) {
    EXPECT_GE(f, 0.0);
    EXPECT_LE(f, 1.0 + 1e-12);
  }
  EXPECT_LT(made.gauges.trapped_air, 1e-15);
}

TEST_P(HandOverOfHeaps, ReadsTheSameSpreadBeforeAndAfter) {
  for (const double cell : {0.02, 0.013, 0.008}) {
    auto set = std::vector<std::string>{"material.youngs_modulus=1e8"};  // so stiff that nothing settles
    auto target = scene(cell);
    target.material.youngs_modulus = 1e8;
    MaterialState state = random_heap(target, 5, reach());
    // A quarter's state has no rings of its own: the round heap's front is known, h = 3 mm before its edge.
    double deepest = 0.0;
    for (const double depth : state.columns.depth) deepest = std::max(deepest, depth);
    const double before = GetParam() == "quarter"
                              ? 2.0 * reach() * (1.0 - std::pow(target.gauges.spread_depth / deepest, 2))
                              : spread_of(target, state);
    const double allowed = (GetParam() == "quarter" ? 0.2 : 0.1) * std::max(cell, state.columns.width);
    EXPECT_NEAR(spread_of(target, mpm::seeds_of_state(target, state)), before, allowed)
        << "particles, " << cell;
    if (GetParam() == "plane") continue;
    const runs::TemporaryFolder folder;
    EXPECT_NEAR(CaseState(target, state, folder.path()).spread(), before, allowed) << "cells, " << cell;
  }
}

INSTANTIATE_TEST_SUITE_P(Everywhere, HandOverOfHeaps, testing::Values("axisymmetric", "plane", "quarter"),
                         [](const auto& dimension) { return dimension.param; });

TEST_F(HandOver, CarriesStressesThatDoNotPassTheirLargest) {
  const auto scene = slump({"foam.cell=0.02", "foam.base_rows=4"});
  const MaterialState state = compare::exact::arrested_state("exact/second-order", scene);
  const CaseState made(scene, state, folder / "case");
  const auto invariant = [](double xx, double xy, double xz, double yy, double yz, double zz) {
    return std::sqrt(0.5 * (xx * xx + yy * yy + zz * zz) + xy * xy + xz * xz + yz * yz);
  };
  double largest = 0.0, of_particles = 0.0;
  for (std::size_t c = 0; c < made.fields.fraction.size(); ++c) {
    const double* s = &made.stress[6 * c];
    EXPECT_NEAR(s[0] + s[3] + s[5], 0.0, 1e-9);
    largest = std::max(largest, invariant(s[0], s[1], s[2], s[3], s[4], s[5]));
  }
  for (const auto& seed : mpm::seeds_of_state(scene, state)) {
    const auto& d = seed.deviator;
    of_particles = std::max(of_particles, invariant(d[0], d[2], 0.0, d[1], 0.0, -d[0] - d[1]));
    EXPECT_GT(d[2], 0.0) << "the base drags back what moved outwards: shear is positive";
  }
  EXPECT_NEAR(largest, scene.material.yield_stress, 0.01 * scene.material.yield_stress);
  EXPECT_LE(largest, scene.material.yield_stress * (1.0 + 1e-12));
  EXPECT_NEAR(of_particles, scene.material.yield_stress, 0.01 * scene.material.yield_stress);
  EXPECT_LE(of_particles, scene.material.yield_stress * (1.0 + 1e-12));
}

TEST_F(HandOver, OfAnArrestedShapeLeavesASolidWhereItIs) {
  const auto scene = slump({"mpm.cell=0.01", "time.end=1"});
  const double exact = 1e3 * spread_of(scene, compare::exact::arrested_state("exact/second-order", scene));
  const runs::Run run = run_mpm(scene, "arrested", "exact/second-order");
  EXPECT_EQ(run.info["started_from"]["model"], "second-order");
  EXPECT_NEAR(run.history.at("spread_mm").front(), exact, 2.0);
  EXPECT_NEAR(run.history.at("spread_mm").back(), exact, 0.005 * exact);
}

TEST_F(HandOver, ToTheSameCellsGoesOnLikeTheOriginal) {
  const auto scene = slump();
  const runs::Run original = run_mpm(scene, "original"),
                  second = run_mpm(scene, "second", at("original", 1.0));
  EXPECT_EQ(second.history.at("time_s").front(), 1.0);
  EXPECT_NEAR(spread_at(second, 1.0), spread_at(original, 1.0), 1e-3);
  EXPECT_NEAR(spread_at(second, 3.0), spread_at(original, 3.0), 0.005 * spread_at(original, 3.0));
  EXPECT_EQ(second.info["started_from"]["solver"], "mpm");
  EXPECT_EQ(second.info["started_from"]["time_s"], 1.0);
}

TEST_F(HandOver, ToCellsAndBackAtOnceMovesTheSpreadByLessThanAThirdOfACell) {
  const auto scene = slump({"foam.cell=0.02", "foam.base_rows=4", "time.end=1"});
  run_mpm(scene, "original");
  for (const double time : {0.5, 1.0}) {
    const MaterialState state = mpm::read_state(at("original", time));
    const CaseState made(scene, state, folder / fmt::format("case{}", time));
    EXPECT_NEAR(made.spread(), spread_of(scene, state), 0.02 / 3.0) << time;
    expect_kept(state, [&] {
      Sums sums = made.sums();
      sums.flocculation = state.flocculation() * sums.volume;  // it has none
      return sums;
    }());
    // Back: the case as a run of OpenFOAM would leave it.
    const fs::path run = folder / fmt::format("run{}", time);
    fs::create_directories(run);
    fs::rename(folder / fmt::format("case{}", time), run / "case");
    std::ofstream(run / "run.json") << nlohmann::ordered_json{
        {"format", runs::run_format},
        {"format_version", runs::run_format_version},
        {"solver", "foam"},
        {"status", "end-time"},
        {"scene_name", "roussel-slump"},
        {"resolved_toml",
         scenes::resolved_toml(scene)}}.dump();
    const MaterialState back = foam::read_state(run.string());
    EXPECT_EQ(back.time, time);
    const auto seeds = mpm::seeds_of_state(scene, back);
    expect_kept(back, sums_of(scene, seeds));
    EXPECT_NEAR(spread_of(scene, seeds), spread_of(scene, state), 0.1 * 0.02) << time;
    EXPECT_NEAR(back.volume(), state.volume(), 1e-10 * state.volume());
    for (std::size_t a = 0; a < 3; a += 2)
      EXPECT_NEAR(back.momentum()[a], state.momentum()[a], 1e-6 * std::abs(state.momentum()[a])) << a;
  }
}

TEST_F(HandOver, GoesOnBitForBitWhereItWasStopped) {
  const auto scene = slump({"time.end=0.8", "output.snapshot_interval=0.1"});
  run_mpm(slump({"time.end=0.5", "output.snapshot_interval=0.1"}), "original");
  const runs::Run whole = run_mpm(scene, "whole", at("original", 0.4));
  mpm::RunOptions options;
  options.directory = folder / "stopped";
  options.quiet = true;
  options.from = at("original", 0.4);
  options.read_state = [](const std::string& asked, const scenes::Scene&) { return mpm::read_state(asked); };
  for (const int steps : {0, 30}) {
    options.force = true;
    options.interrupted = [steps, asked = 0]() mutable { return asked++ == steps; };
    EXPECT_EQ(mpm::run(scene, options).status, runs::Status::interrupted);
    mpm::RunOptions leg = options;
    leg.force = false;
    leg.interrupted = [] { return false; };
    mpm::resume(leg);
    const runs::Run resumed = runs::read_run(options.directory);
    EXPECT_EQ(resumed.history.columns, whole.history.columns) << steps;
    EXPECT_EQ(resumed.info["started_from"], whole.info["started_from"]);
  }
}

TEST_F(HandOver, SaysWhatItDoesNotServe) {
  const auto scene = slump({"time.end=0.2", "output.snapshot_interval=0.1"});
  run_mpm(scene, "original");
  const auto start = [&](const std::vector<std::string>& set, double time) {
    auto all = std::vector<std::string>{"time.end=1"};
    all.insert(all.end(), set.begin(), set.end());
    return refusal([&] { run_mpm(slump(all), "refused", at("original", time)); });
  };
  EXPECT_THAT(start({}, 0.15), AllOf(HasSubstr("recorded no state"), HasSubstr("0, 0.1, 0.2 s")));
  EXPECT_THAT(start({"geometry.dimension=quarter"}, 0.1),
              HasSubstr("axisymmetric, and geometry.dimension is quarter"));
  EXPECT_THAT(start({"material.density=2000"}, 0.1), HasSubstr("2300 kg/m3, and material.density is 2000"));
  EXPECT_THAT(start({"geometry.cone_height=0.25"}, 0.1), HasSubstr("m3 of material, and the scene's body"));
  EXPECT_THAT(start({"time.end=0.1"}, 0.1), HasSubstr("a later end"));
  EXPECT_THAT(start(thixotropic(), 0.1), HasSubstr("how far its material has flocculated"));
  EXPECT_THAT(refusal([&] { run_mpm(scenes::load_scene("printing-1"), "refused", at("original", 0.1)); }),
              HasSubstr("as a slump does"));
  EXPECT_THAT(refusal([&] { runs::state_name("run@soon"); }), HasSubstr("'soon' is no time"));
  EXPECT_THAT(refusal([&] { run_mpm(scene, "refused", "exact/second-order@5"); }), HasSubstr("has no time"));
  EXPECT_THAT(refusal([&] { run_mpm(scene, "refused", "exact/third-order"); }),
              HasSubstr("exact/second-order"));
  EXPECT_FALSE(fs::exists(folder / "refused"));
}

TEST_F(HandOver, IsAnotherRunThanThatOfTheScenesBody) {
  const auto scene = slump({"time.end=0.2", "output.snapshot_interval=0.1"});
  run_mpm(scene, "original");
  run_mpm(scene, "run", at("original", 0.1));
  EXPECT_EQ(refusal([&] { run_mpm(scene, "run", at("original", 0.1)); }), "accepted");
  EXPECT_THAT(refusal([&] { run_mpm(scene, "run"); }), HasSubstr("and its scene's body here"));
  EXPECT_THAT(refusal([&] { run_mpm(scene, "run", at("original", 0.0)); }), HasSubstr("it starts from"));
}
