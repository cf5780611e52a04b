#include "compare/exact/film.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "compare/exact/exact_run.h"
#include "runs/depth.h"
#include "runs/run_directory.h"

namespace flowrest::compare::exact {
namespace {

constexpr Bingham roussel{2300.0, 50.0, 50.0};
constexpr double gravity = 9.81;
constexpr double volume = 5.49779e-3;  // m3

SpreadingFilm bingham_film(int rings = 225) {
  return bingham_film(roussel, gravity, 0.1, volume, 0.45, rings, false);
}

SpreadingFilm regularised_film(laws::Law law, double time, int rings = 90) {
  const RegularisedFluid fluid =
      regularised_fluid(law, roussel.yield_stress, roussel.plastic_viscosity, time);
  return {[fluid](double depth, double slope) {
            return film_flux(fluid, roussel.density, gravity, depth, slope);
          },
          0.1, volume, 0.45, rings};
}

double centre_at(const SpreadingFilm& film) {
  const auto centres = film.state().centres();
  return runs::centre_depth({centres, film.state().depth}, 0.003);
}

double spread_at(SpreadingFilm& film, double time) {
  film.advance_to(time);
  const auto centres = film.state().centres();
  return runs::spread({centres, film.state().depth}, 0.003);
}

TEST(Film, AStiffRegularisedFluidFlowsAsBinghamDoes) {
  const RegularisedFluid fluid = regularised_fluid(laws::Law::bi_viscous, 50.0, 50.0, 1e7);
  for (const double slope : {0.05, 0.2, -0.4}) {
    const double exact = film_flux(roussel, gravity, 0.05, slope);
    EXPECT_NEAR(film_flux(fluid, 2300.0, gravity, 0.05, slope), exact, 1e-5 * std::abs(exact) + 1e-12)
        << slope;
  }
  EXPECT_EQ(film_flux(roussel, gravity, 0.05, 0.04), 0.0);  // 45 Pa at the base
}

TEST(Film, ARegularisedFluidsFluxIsThatOfItsMeanVelocity) {
  for (const auto law : {laws::Law::papanastasiou, laws::Law::bi_viscous})
    for (const double time : {10.0, 1000.0}) {
      const RegularisedFluid fluid = regularised_fluid(law, 50.0, 50.0, time);
      for (const double slope : {0.01, 0.044, 0.0444, 0.06, 0.5}) {
        const double exact = 0.05 * film_velocity(fluid, 0.05, 2300.0 * gravity * 0.05 * slope);
        EXPECT_NEAR(film_flux(fluid, 2300.0, gravity, 0.05, slope), exact, 1e-4 * exact)
            << time << " s, " << slope;
      }
    }
}

TEST(Film, ANewtonianFilmCarriesNusseltsFlux) {
  const Bingham newtonian{1000.0, 0.0, 2.0};
  EXPECT_DOUBLE_EQ(film_flux(newtonian, 10.0, 0.03, 0.1), 1000.0 * 10.0 * 0.1 * 2.7e-5 / 6.0);
}

TEST(Film, KeepsItsVolumeAndApproachesTheArrestedShapeFromBelow) {
  auto film = bingham_film();
  const auto arrested = leading_order_slump(roussel, gravity, volume);
  double earlier = 0.0;
  for (const double time : {1.0, 10.0, 60.0, 1000.0}) {
    const double spread = spread_at(film, time);
    EXPECT_GT(spread, earlier);
    EXPECT_LT(spread, arrested.spread(0.003));
    earlier = spread;
  }
  EXPECT_NEAR(earlier, arrested.spread(0.003), 0.002);
  EXPECT_NEAR(film.state().volume(), volume, 1e-8 * volume);
  EXPECT_NEAR(centre_at(film), arrested.depth(0.0), 5e-4);
}

/// The pull takes all slope from a film no deeper than the nose, and the same stress from a deeper one.
TEST(Film, APlugsPullActsAsLessSlope) {
  const double pull = plug_pull * roussel.yield_stress / (roussel.density * gravity);
  EXPECT_EQ(slope_under_plug(roussel, gravity, pull, 0.5), 0.0);
  for (const double slope : {0.05, -0.3})
    EXPECT_NEAR(roussel.density * gravity * 0.04 * slope_under_plug(roussel, gravity, 0.04, slope),
                (roussel.density * gravity * 0.04 - plug_pull * roussel.yield_stress) * slope, 1e-10);
}

/// Under its plug's pull a film comes to the second-order slump: 4 cm in spread from the leading-order one,
/// and found to a ring or two.
TEST(Film, UnderItsPlugsPullApproachesTheSecondOrderShape) {
  SpreadingFilm film = bingham_film(roussel, gravity, 0.1, volume, 0.45, 225, true);
  const auto arrested = second_order_slump(roussel, gravity, volume);
  EXPECT_LT(arrested.spread(0.003), leading_order_slump(roussel, gravity, volume).spread(0.003) - 0.02);
  double earlier = 0.0;
  for (const double time : {5.0, 60.0, 1000.0}) {
    const double spread = spread_at(film, time);
    EXPECT_GT(spread, earlier);
    earlier = spread;
  }
  EXPECT_NEAR(earlier, arrested.spread(0.003), 0.008);
  EXPECT_NEAR(film.state().volume(), volume, 1e-8 * volume);
  EXPECT_NEAR(centre_at(film), arrested.depth(0.0), 1e-3);
}

/// The growth still to come falls as 1/t: what the centre sinks from 50 to 100 s is four times what it sinks
/// from 200 to 400 s.
TEST(Film, IsNeverAtRestInFiniteTime) {
  auto film = bingham_film();
  const auto centre = [&](double time) {
    film.advance_to(time);
    return film.state().depth.front();
  };
  const double at_50 = centre(50.0), at_100 = centre(100.0), at_200 = centre(200.0), at_400 = centre(400.0);
  const double early = at_50 - at_100, late = at_200 - at_400;
  EXPECT_NEAR(std::log(early / late) / std::log(4.0), 1.0, 0.15);
}

/// Refining the rings moves the spread by less than a ring.
TEST(Film, ConvergesWithItsRings) {
  auto coarse = bingham_film(90), fine = bingham_film(360);
  EXPECT_NEAR(spread_at(coarse, 60.0), spread_at(fine, 60.0), 0.003);
  EXPECT_NEAR(spread_at(fine, 60.0), 0.585, 0.002);
}

TEST(Film, ARegularisedOnePassesTheArrestedShapeTheSoonerTheSofterItIs) {
  auto exact = bingham_film(90);
  auto soft = regularised_film(laws::Law::bi_viscous, 10.0);
  auto stiff = regularised_film(laws::Law::bi_viscous, 1000.0);
  const double at_rest = spread_at(exact, 30.0);
  EXPECT_NEAR(spread_at(stiff, 30.0), at_rest, 0.002);
  EXPECT_GT(spread_at(soft, 30.0), at_rest + 0.014);
}

TEST(Film, LeavesARunOfWhatAScenesMaterialDoes) {
  const auto directory = std::filesystem::temp_directory_path() / "flowrest-film-test";
  std::filesystem::remove_all(directory);
  const auto scene =
      scenes::load_scene("roussel-slump", {{"time.end=2", "output.history_interval=0.5"}, std::nullopt});
  write_film_run(scene, directory);
  const auto run = runs::read_run(directory);
  EXPECT_EQ(run.info["status"], "end-time");
  ASSERT_EQ(run.history.rows(), 5U);
  EXPECT_NEAR(run.history.at("spread_mm").back(), 488.6, 2.0);
  EXPECT_NEAR(run.history.at("volume_m3").back(), scene.slump().volume(), 1e-9);
  EXPECT_DOUBLE_EQ(run.profiles.back().time, 2.0);
  std::filesystem::remove_all(directory);
  write_film_run(scene, directory, true);
  EXPECT_NEAR(runs::read_run(directory).history.at("spread_mm").back(), 477.6, 2.0);
  std::filesystem::remove_all(directory);
  for (const char* set : {"walls.base=slip", "geometry.dimension=plane"})
    EXPECT_THROW(write_film_run(scenes::load_scene("roussel-slump", {{set}, std::nullopt}), directory),
                 runs::RunError);
  EXPECT_FALSE(std::filesystem::exists(directory));
}

TEST(Film, TheSpeedOfItsApproachIsTheSlopeOfAFinerFilm) {
  const Approach at_60 = approach_to_rest(roussel, gravity, 0.1, volume, 0.45, 60.0, 0.003);
  // Over so long that rings do not matter: spread = rest - c / t.
  SpreadingFilm film = bingham_film(900);
  const double early = spread_at(film, 30.0), late = spread_at(film, 120.0);
  const double c = (late - early) / (1.0 / 30.0 - 1.0 / 120.0);
  EXPECT_NEAR(at_60.film / (c / 3600.0), 1.0, 0.1);
  // The plug's pull leaves it less to go.
  EXPECT_LT(at_60.under_plug, 0.85 * at_60.film);
  EXPECT_GT(at_60.under_plug, 0.4 * at_60.film);
  // As 1 / t^2.
  const Approach at_120 = approach_to_rest(roussel, gravity, 0.1, volume, 0.45, 120.0, 0.003);
  EXPECT_NEAR(at_60.film / at_120.film, 4.0, 1.2);
}

}  // namespace
}  // namespace flowrest::compare::exact
