// What a user may do to a scene by mistake or on purpose: nothing may end as silently wrong.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>

#include "mpm/output/test_runs.h"
#include "mpm/solver/test_bodies.h"
#include "runs/gauges.h"
#include "scenes/step_limits.h"

using namespace flowrest;
using namespace flowrest::mpm;
using namespace flowrest::mpm::test;
using testing::HasSubstr;

namespace {

class Extremes : public RunTest {};

/// Every number of a history is finite, but where there may be nothing to read, and the mass stays what it was.
void expect_sane(const runs::Run& run, const std::string& what) {
  const auto& mass = run.history.at("volume_at_rest_m3");
  for (std::size_t c = 0; c < run.history.names.size(); ++c)
    for (const double v : run.history.columns[c])
      EXPECT_TRUE(std::isfinite(v) || (std::isnan(v) && runs::may_read_nothing(run.history.names[c])))
          << what << ' ' << run.history.names[c];
  for (const double m : mass) EXPECT_NEAR(m, mass.front(), 1e-6 * mass.front()) << what;
}

}  // namespace

TEST_F(Extremes, PastItsViscousLimitAnExplicitFluidIsRefusedAndWhereForcedItIsCalledNoisy) {
  // Nothing blows up there: the capped stress chatters, and the spread looks like any other.
  const std::vector<std::string> fluid = {"material.model=papanastasiou", "mpm.fluid_update=explicit",
                                          "mpm.time_step=0.001"};
  const auto message = [&] {
    try {
      tiny_slump(fluid);
    } catch (const scenes::SceneError& error) {
      return std::string(error.what());
    }
    return std::string();
  }();
  EXPECT_THAT(message, HasSubstr("past the viscous limit"));
  const auto forced = tiny_slump(with(fluid, {"mpm.allow_unstable_step=true"}));
  ASSERT_GT(0.001, 10.0 * scenes::step_limits(forced).viscous);
  const auto run = run_and_read(forced);
  EXPECT_EQ(run.status(), runs::Status::end_time);
  EXPECT_THAT(run.info["verdict"].get<std::string>(), HasSubstr("viscous limit"));
  // Left to itself the step keeps below the limit.
  const auto held = tiny_slump({"material.model=papanastasiou", "mpm.fluid_update=explicit",
                                "material.regularisation_time=1", "time.end=0.1"});
  const auto obedient = run_and_read(held, "held");
  for (const double step : obedient.history.at("time_step_s"))
    EXPECT_LE(step, 1.0000001 * scenes::step_limits(held).viscous);
}

TEST_F(Extremes, WhatStandsStillByRoundOffIsNotCalledSound) {
  // Steps so short that in float no particle leaves its place though all of them fall; in double they do.
  const std::vector<std::string> short_steps = {
      "mpm.time_step=1e-7", "time.end=1e-4", "output.history_interval=2e-5", "output.checkpoint_interval=1"};
  const auto centre_falls = [&](const std::string& precision) {
    const auto run = run_and_read(tiny_slump(with(short_steps, {"mpm.precision=" + precision})), precision);
    const auto& energy = run.history.at("potential_energy_J");
    return std::pair{energy.front() - energy.back(), run.info["verdict"].get<std::string>()};
  };
  const auto [fall, verdict] = centre_falls("double");
  EXPECT_GT(fall, 0.0);
  EXPECT_EQ(verdict, "sound");
  const auto [fake_rest, said] = centre_falls("float");
  EXPECT_EQ(fake_rest, 0.0) << "the mode that is to be detected was not provoked";
  EXPECT_THAT(said, HasSubstr("stands still by round-off"));
}

TEST_F(Extremes, WhatFallsAsFastAsSoundLandsAndWhatFallsFasterIsRefused) {
  // At 1.8 times the speed of sound it rebounds with a tenth of its energy made, with steps however short.
  const auto gravity = [](double over_sound) {
    const auto usual = tiny_slump();
    const double fall = over_sound * usual.material.longitudinal_speed();
    return fmt::format("forces.gravity={:.17g}", fall * fall / (2.0 * usual.body_height()));
  };
  for (const char* scheme : {"quadratic-apic", "linear-flip"})
    for (const char* model : {"elasto-viscoplastic", "newtonian"}) {
      const auto run =
          run_and_read(tiny_slump({gravity(0.999), std::string("mpm.scheme=") + scheme,
                                   std::string("material.model=") + model, "geometry.domain_radius=2"}));
      EXPECT_EQ(run.status(), runs::Status::end_time) << scheme << ' ' << model;
      expect_sane(run, scheme);
    }
  EXPECT_THROW(tiny_slump({gravity(1.001)}), scenes::SceneError);
}

TEST_F(Extremes, ASingleParticleAndBodiesOneCellThickComeToAnEndAndAreSaidToBeUnresolved) {
  const std::vector<std::vector<std::string>> bodies = {
      {"geometry.cone_height=0.02", "geometry.cone_radius_top=0.0", "geometry.cone_radius_bottom=0.02",
       "foam.cell=0.02", "mpm.particles_per_cell=1"},
      {"geometry.cone_height=0.02", "foam.cell=0.02"},
      {"geometry.cone_radius_top=0.02", "geometry.cone_radius_bottom=0.02", "foam.cell=0.02"}};
  for (const char* scheme : {"quadratic-apic", "linear-flip"})
    for (const char* precision : {"double", "float"})
      for (const auto& body : bodies) {
        const auto scene =
            tiny_slump(with(body, {std::string("mpm.scheme=") + scheme,
                                   std::string("mpm.precision=") + precision, "time.end=0.1"}));
        const auto run = run_and_read(scene);
        expect_sane(run, std::string(scheme) + ' ' + precision + ' ' + body.front());
        if (&body != &bodies.back()) {
          EXPECT_THAT(run.info["verdict"].get<std::string>(), HasSubstr("under-resolved"));
        }
      }
}

TEST_F(Extremes, ADomainOneCellThickComesToAnEndAndIsSaidToBeUnresolved) {
  const auto duct = [](const std::string& cell, const std::string& scheme, const std::string& precision) {
    return scenes::load_scene("poiseuille-10",
                              {{"mpm.cell=" + cell, "foam.cell=" + cell, "mpm.scheme=" + scheme,
                                "mpm.precision=" + precision, "time.end=0.2", "mpm.threads=1"},
                               {}});
  };
  for (const char* scheme : {"quadratic-apic", "linear-flip"})
    for (const char* precision : {"double", "float"}) {
      const auto run = run_and_read(duct("0.5", scheme, precision));
      expect_sane(run, std::string(scheme) + ' ' + precision);
      EXPECT_THAT(run.info["verdict"].get<std::string>(),
                  HasSubstr("1.0 cells across the narrowest passage"));
    }
  EXPECT_THAT(run_and_read(duct("0.05", "quadratic-apic", "double")).info["verdict"].get<std::string>(),
              Not(HasSubstr("across the narrowest passage")));
}

TEST_F(Extremes, ASlumpOfAMicrometreAndOneOfAKilometreAreTheSameSlumpInTheirOwnUnits) {
  // Lengths times L, times times sqrt(L), stresses times L, viscosity times L^1.5: Froude's and Bingham's
  // numbers stay.
  const auto spread_in_lengths = [&](double length, const std::string& precision) {
    const auto set = [](const std::string& key, double value) {
      return key + "=" + fmt::format("{:.17g}", value);
    };
    const double time = std::sqrt(length);
    const auto run = run_and_read(
        tiny_slump({set("geometry.cone_height", 0.3 * length), set("geometry.cone_radius_top", 0.05 * length),
                    set("geometry.cone_radius_bottom", 0.1 * length),
                    set("geometry.domain_radius", 0.45 * length),
                    set("geometry.domain_height", 0.35 * length), set("mpm.cell", 0.02 * length),
                    set("foam.cell", 0.02 * length), set("material.yield_stress", 50.0 * length),
                    set("material.youngs_modulus", 1e5 * length),
                    set("material.plastic_viscosity", 50.0 * std::pow(length, 1.5)),
                    set("time.end", 0.3 * time), set("output.history_interval", 0.05 * time),
                    set("output.profile_interval", 0.1 * time), "mpm.precision=" + precision}),
        precision);
    expect_sane(run, precision);
    return run.history.at("spread_mass_995_mm").back() * 1e-3 / length;
  };
  for (const char* precision : {"double", "float"}) {
    const double usual = spread_in_lengths(1.0, precision);
    EXPECT_GT(usual, 0.2);
    for (const double length : {1e-6, 1e3})
      EXPECT_NEAR(spread_in_lengths(length, precision), usual, 1e-3 * usual);
  }
}

TEST(Walls, NoParticleIsLostThroughThemHoweverItStartsOrIsThrown) {
  for (const Variant& v : every_variant()) {
    if (v.dimension == 3) continue;
    SolverSettings s = concrete(v);
    s.bounds[0] = {PlaneWall::slip, PlaneWall::slip, 0, 6, false};
    s.bounds[1] = {PlaneWall::no_slip, PlaneWall::no_slip, 0, 6, false};
    auto seeds = block(s, {0, 0, 0}, {6, 3, 0}, 2);
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      // On faces and corners of cells, which are walls at the edges; thrown at floor and side.
      if (i % 2 == 0) seeds[i].position = {0.0, i % 4 == 0 ? 0.0 : 0.5, 0.0};
      seeds[i].velocity = {i % 3 == 0 ? 2.0 : -2.0, -3.0, 0.0};
    }
    auto solver = make_solver(s, seeds);
    for (int i = 0; i < 300; ++i) solver->step(0.3 * usual_step(s), {0.0, -9.81, 0.0});
    std::size_t inside = 0;
    solver->visit([&](const ParticleBatch& b) {
      for (std::size_t i = 0; i < b.count; ++i) {
        bool in = true;
        for (std::size_t a = 0; a < 2; ++a)
          in = in && b.position[a][i] >= 0.0 && b.position[a][i] <= 6.0 * s.cell &&
               std::isfinite(b.velocity[a][i]);
        inside += in;
      }
    });
    EXPECT_EQ(inside, seeds.size()) << name_of(v);
  }
}
