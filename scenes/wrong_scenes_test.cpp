#include "scenes/test_scenes.h"

/// Scenes that must be refused, each with the message it must be refused with.
namespace flowrest::scenes::test {
namespace {

const std::string fluid_text =
    replaced(slump_text, "model = \"elasto-viscoplastic\"", "model = \"papanastasiou\"");
const std::string fine_text = replaced(slump_text, "cell = 0.01\nparticles", "cell = 2e-5\nparticles");
const std::string thixotropic_text =
    replaced(slump_text, "[walls]",
             "[thixotropy]\nflocculation_rate = 0.4\n"
             "deflocculation_coefficient = 0.1\ninitial_flocculation = 0\n[walls]");

/// A container with no more than it needs.
std::string container_text(const std::string& kind) {
  return "title = \"A container\"\nkind = \"" + kind + R"("
[material]
model = "newtonian"
density = 1000
plastic_viscosity = 1
bulk_modulus = 1e6
poisson_ratio = 0.45
[time]
end = 1
[mpm]

cell = 0.01
)";
}
const std::string l_box_text = container_text("l-box");
const std::string v_funnel_text = container_text("v-funnel");
const std::string dam_text = container_text("dam-break");
const std::string print_text =
    container_text("printing") + "[process]\nprinting_velocity = 0.03\nextrusion_velocity = 0.0336\n";

/// Text, what is replaced in it, and the message (or its beginning, where it is long).
struct Wrong {
  const char* name;
  const std::string& text;
  const char* from;
  const char* to;
  const char* message;
};
void PrintTo(const Wrong& wrong, std::ostream* stream) { *stream << wrong.to; }

const Wrong wrong_scenes[] = {
    {"NoToml", slump_text, "cell = 0.01\nparticles", "cell = \nparticles",
     "wrong.toml:34:8: is not valid TOML: Error while parsing key-value pair: expected value, saw '\\n'"},
    {"UnclosedString", slump_text, "title = \"A slump\"", "title = \"A slump",
     "wrong.toml:1:17: is not valid TOML: Error while parsing string: unescaped control characters other "
     "than TAB (U+0009) are explicitly prohibited"},
    {"KeyGivenTwice", slump_text, "cfl = 0.75", "cfl = 0.75\ncfl = 0.5",
     "wrong.toml:37:7: is not valid TOML: Error while parsing key-value pair: cannot redefine existing "
     "floating-point 'cfl'"},
    {"SectionGivenTwice", slump_text, "[foam]", "[mpm]",
     "wrong.toml:37:1: is not valid TOML: Error while parsing table header: cannot redefine existing table "
     "'mpm'"},
    {"NoUtf8", slump_text, "\"A slump\"",
     "\"A \xff"
     " slump\"",
     "wrong.toml:1:11: is not valid TOML: Encountered invalid utf-8 sequence"},
    {"UnknownKeyNearAKnownOne", slump_text, "cfl = 0.75", "clf = 0.75",
     "wrong.toml:36:1: unknown key \"mpm.clf\", nearest is cfl; allowed: scheme, cell, particles_per_cell, "
     "cfl, time_step, allow_unstable_step, precision,"},
    {"UnknownKeyOfMaterial", slump_text, "yield_stress = 50", "yeild_stress = 50",
     "wrong.toml:11:2: material.yield_stress is missing; needed by the model elasto-viscoplastic"},
    {"UnknownKeyNearNothing", slump_text, "cfl = 0.75", "colour = \"grey\"",
     "wrong.toml:36:1: unknown key \"mpm.colour\"; allowed: scheme, cell, particles_per_cell, cfl, "
     "time_step, allow_unstable_step, precision, threads,"},
    {"KeyOfAnotherSection", slump_text, "cfl = 0.75", "gravity = 9.81",
     "wrong.toml:36:1: unknown key \"mpm.gravity\", gravity belongs to [forces]; allowed: scheme, cell, "
     "particles_per_cell, cfl, time_step,"},
    {"KeyWithoutItsSection", slump_text, "kind = \"slump\"", "kind = \"slump\"\ndensity = 2300",
     "wrong.toml:3:1: unknown key \"density\", density belongs to [material]; allowed: title, kind, extends, "
     "[runs], [geometry], [process], [material], [thixotropy],"},
    {"UnknownSection", slump_text, "[foam]", "[faom]",
     "wrong.toml:37:2: unknown section \"faom\", nearest is foam; allowed: runs, geometry, process, material, "
     "thixotropy, walls, forces, time, output, gauges, mpm, foam"},
    {"UnknownTopKey", slump_text, "title =", "titel =",
     "wrong.toml:1:1: unknown key \"titel\", nearest is title; allowed: title, kind, extends, [runs], "
     "[geometry], [process], [material], [thixotropy], [walls],"},
    {"KeyBelowAKey", slump_text, "cfl = 0.75", "grid.cell = 0.01",
     "wrong.toml:36:1: unknown key \"mpm.grid\"; allowed: scheme, cell, particles_per_cell, cfl, time_step, "
     "allow_unstable_step, precision, threads, seeding,"},
    {"SectionThatIsANumber", duct_text, "kind = \"duct\"", "kind = \"duct\"\nwalls = 20",
     "wrong.toml:3:9: walls must be a table, not an integer; allowed keys: base"},
    {"SectionThatIsAList", slump_text, "[foam]", "[[foam]]",
     "wrong.toml:37:1: foam must be a table, not an array; allowed keys: cell, max_courant, max_time_step, "
     "step_growth, air_density, air_kinematic_viscosity, wedge_angle"},
    {"NumberGivenAsString", slump_text, "density = 2300.0", "density = \"2300\"",
     "wrong.toml:13:11: material.density must be a number, not a string"},
    {"NumberGivenAsBoolean", slump_text, "density = 2300.0", "density = true",
     "wrong.toml:13:11: material.density must be a number, not a boolean"},
    {"NumberGivenAsTable", slump_text, "density = 2300.0", "density = { value = 2300.0 }",
     "wrong.toml:13:11: material.density must be a number, not a table"},
    {"NumberGivenAsDate", slump_text, "density = 2300.0", "density = 2026-01-01",
     "wrong.toml:13:11: material.density must be a number, not a date"},
    {"NumberGivenAsArray", slump_text, "density = 2300.0", "density = [2300.0]",
     "wrong.toml:13:11: material.density must be a number, not an array"},
    {"BooleanGivenAsString", slump_text, "stop_at_rest = true", "stop_at_rest = \"yes\"",
     "wrong.toml:25:16: time.stop_at_rest must be true or false, not a string"},
    {"BooleanGivenAsNumber", slump_text, "exact = true", "exact = 1",
     "wrong.toml:3:75: runs.exact must be true or false, not an integer"},
    {"ChoiceGivenAsNumber", slump_text, "scheme = \"quadratic-apic\"", "scheme = 2",
     "wrong.toml:33:10: mpm.scheme must be a string, not an integer; allowed: quadratic-apic, linear-flip, "
     "paper"},
    {"TitleGivenAsNumber", slump_text, "title = \"A slump\"", "title = 1",
     "wrong.toml:1:9: title must be a string, not an integer"},
    {"EmptyTitle", slump_text, "title = \"A slump\"", "title = \"\"",
     "wrong.toml:1:9: title has 0 bytes; allowed: 1 to 200"},
    {"IntegerGivenAsNumber", slump_text, "cfl = 0.75", "threads = 1.5",
     "wrong.toml:36:11: mpm.threads must be an integer, not a number"},
    {"ModelsGivenAsNumber", slump_text, "mpm = [\"elasto-viscoplastic\"]", "mpm = 3",
     "wrong.toml:3:16: runs.mpm must be a string, not an integer; allowed: elasto-viscoplastic, "
     "papanastasiou, bi-viscous, herschel-bulkley, newtonian"},
    {"ModelGivenAsNumber", slump_text, "mpm = [\"elasto-viscoplastic\"]", "mpm = [3]",
     "wrong.toml:3:17: runs.mpm must be a string, not an integer; allowed: elasto-viscoplastic, "
     "papanastasiou, bi-viscous, herschel-bulkley, newtonian"},
    {"ExtendsGivenAsNumber", slump_text, "kind = \"slump\"", "kind = \"slump\"\nextends = 3",
     "wrong.toml:3:11: extends must be a string, not an integer"},
    {"UnknownKind", slump_text, "kind = \"slump\"", "kind = \"slmp\"",
     "wrong.toml:2:8: kind is \"slmp\", nearest is \"slump\"; allowed: slump, duct"},
    {"UnknownModel", slump_text, "model = \"elasto-viscoplastic\"", "model = \"elastoviscoplastic\"",
     "wrong.toml:12:9: material.model is \"elastoviscoplastic\", nearest is \"elasto-viscoplastic\"; "
     "allowed: elasto-viscoplastic, papanastasiou, bi-viscous,"},
    {"UnknownScheme", slump_text, "\"quadratic-apic\"", "\"cubic\"",
     "wrong.toml:33:10: mpm.scheme is \"cubic\"; allowed: quadratic-apic, linear-flip, paper"},
    {"UnknownDimension", slump_text, "\"axisymmetric\"", "\"axisymetric\"",
     "wrong.toml:5:13: geometry.dimension is \"axisymetric\", nearest is \"axisymmetric\"; allowed: "
     "axisymmetric, plane, half, quarter, full"},
    {"UnknownPrecision", slump_text, "cfl = 0.75", "precision = \"single\"",
     "wrong.toml:36:13: mpm.precision is \"single\"; allowed: double, float"},
    {"UnknownRun", slump_text, "foam = [\"papanastasiou\"]", "foam = [\"papanastasio\"]",
     "wrong.toml:3:49: runs.foam is \"papanastasio\", nearest is \"papanastasiou\"; allowed: "
     "elasto-viscoplastic, papanastasiou, bi-viscous, herschel-bulkley, newtonian"},
    {"RunNamedTwice", slump_text, "mpm = [\"elasto-viscoplastic\"]", "mpm = [\"newtonian\", \"newtonian\"]",
     "wrong.toml:3:30: runs.mpm names newtonian twice; allowed: each model once"},
    {"UnknownWall", slump_text, "base = \"no-slip\"", "base = \"sticky\"",
     "wrong.toml:20:8: walls.base is \"sticky\"; allowed: no-slip, slip, { friction = a number }"},
    {"FrictionIsNegative", slump_text, "base = \"no-slip\"", "base = { friction = -0.3 }",
     "wrong.toml:20:21: walls.base has a friction that is -0.3; allowed: at least 0, at most 10"},
    {"FrictionIsNoNumber", slump_text, "base = \"no-slip\"", "base = { friction = \"much\" }",
     "wrong.toml:20:21: walls.base has a friction that must be a number, not a string"},
    {"FrictionMisspelt", slump_text, "base = \"no-slip\"", "base = { fricton = 0.3 }",
     "wrong.toml:20:20: walls.base has an unknown entry \"fricton\"; allowed: friction"},
    {"MouldThatStandsStill", slump_text, "domain_height = 0.35",
     "domain_height = 0.35\nmould_lift_velocity = 0.0",
     "wrong.toml:11:23: geometry.mould_lift_velocity is 0; allowed: greater than 0, at most 1000"},
    {"FrictionInADuct", duct_text, "[forces]", "[walls]\nbase = { friction = 0.3 }\n[forces]",
     "wrong.toml:12:8: walls.base has friction, which does not suit a duct; allowed: no-slip, slip"},
    {"AxisymmetricLBox", l_box_text, "kind = \"l-box\"",
     "kind = \"l-box\"\ngeometry = { dimension = \"axisymmetric\" }",
     "wrong.toml:3:26: geometry.dimension is axisymmetric, which does not suit a l-box; allowed: plane, "
     "half, full"},
    {"LBoxFullOfBars", l_box_text, "kind = \"l-box\"", "kind = \"l-box\"\ngeometry = { rebars = 20 }",
     "wrong.toml:3:23: 20 bars of 0.012 m fill the width of 0.2 m; allowed: bars that leave gaps"},
    {"LBoxWithoutAFrontWall", l_box_text, "kind = \"l-box\"",
     "kind = \"l-box\"\ngeometry = { channel_height = 0.7 }",
     "wrong.toml:3:31: geometry.channel_height is 0.7 m, the reservoir 0.6 m high; allowed: less than the "
     "reservoir's "
     "height"},
    {"LBoxGateThatStandsStill", l_box_text, "kind = \"l-box\"",
     "kind = \"l-box\"\ngeometry = { gate_lift_velocity = 0 }",
     "wrong.toml:3:35: geometry.gate_lift_velocity is 0; allowed: greater than 0, at most 1000"},
    {"LBoxCellsWiderThanTheChannel", l_box_text, "cell = 0.01", "cell = 0.12",
     "wrong.toml:13:8: mpm.cell is 0.12 m, larger than the channel (0.1 m); allowed: at most 0.1"},
    {"FunnelThatWidensDownwards", v_funnel_text, "[time]", "[geometry]\noutlet_width = 0.6\n[time]",
     "wrong.toml:10:16: geometry.outlet_width is 0.6 m, wider than the top (0.515 m); allowed: at most the "
     "top's width"},
    {"ColumnLongerThanItsTank", dam_text, "[time]", "[geometry]\ncolumn_length = 2.0\n[time]",
     "wrong.toml:10:17: the column of 2 m does not fit the tank of 1.61 m; allowed: at most the tank's "
     "length"},
    {"PrintWithoutASpeed", print_text, "printing_velocity = 0.03\n", "\n",
     "wrong.toml:14:2: process.printing_velocity is missing; needed: speed of the nozzle along the strand"},
    {"PrintBackwards", print_text, "printing_velocity = 0.03", "printing_velocity = [[0, 0.03], [2, -0.01]]",
     "wrong.toml:15:21: process.printing_velocity is -0.01 m/s from 2 s on; allowed: from 0"},
    {"PrintOfNothing", print_text, "extrusion_velocity = 0.0336", "extrusion_velocity = 0",
     "wrong.toml:16:22: process.extrusion_velocity is 0 at all times; allowed: greater than 0 at some"},
    {"PrintWithCellsAsHighAsTheGap", print_text, "cell = 0.01", "cell = 0.012",
     "wrong.toml:13:8: mpm.cell is 0.012 m, larger than the nozzle's gap"},
    {"PrintInOpenFoam", print_text, "kind = \"printing\"",
     "kind = \"printing\"\nruns = { foam = [\"newtonian\"] }",
     "wrong.toml:3:17: runs.foam is given, but printing is not computed in OpenFOAM; allowed: none"},
    {"PrintWithLinearFunctions", print_text, "cell = 0.01", "cell = 0.005\nscheme = \"linear-flip\"",
     "wrong.toml:14:10: mpm.scheme is linear-flip, which holds no nozzle; allowed: quadratic-apic"},
    {"FrictionLeftOut", slump_text, "base = \"no-slip\"", "base = {}",
     "wrong.toml:20:8: walls.base is an empty table; allowed: { friction = a number }"},
    {"NoTitle", slump_text, "title = \"A slump\"\n", "\n",
     "wrong.toml:1:1: title is missing; needed: what every report calls the scene (string, 1 to 200 bytes)"},
    {"NoKind", slump_text, "kind = \"slump\"\n", "\n",
     "wrong.toml:1:1: kind is missing; needed: what is simulated (one of slump, duct, l-box, v-funnel, "
     "dam-break, printing)"},
    {"NoDensity", slump_text, "density = 2300.0\n", "\n",
     "wrong.toml:11:2: material.density is missing; needed: density at rest and without pressure (number, "
     "greater than 0, at most 1e+06, in kg/m3)"},
    {"NoCell", slump_text, "cell = 0.01\nparticles", "particles",
     "wrong.toml:32:2: mpm.cell is missing; needed: edge of a grid cell (number, greater than 0, at most "
     "1e+06, in m)"},
    {"NoSection", duct_text, "[time]\nend = 20\n", "",
     "wrong.toml:1:1: time.end is missing; needed: simulated time at which a run ends (number, greater than "
     "0, at most 1e+12, in s)"},
    {"NoModulus", slump_text, "youngs_modulus = 1.0e5\n", "\n",
     "wrong.toml:11:2: material.youngs_modulus is missing; needed: youngs_modulus or bulk_modulus (Pa)"},
    {"NoYieldStress", slump_text, "yield_stress = 50\n", "\n",
     "wrong.toml:11:2: material.yield_stress is missing; needed by the model elasto-viscoplastic"},
    {"NoRegularisationTime", slump_text, "regularisation_time = 100.0\n", "\n",
     "wrong.toml:11:2: material.regularisation_time is missing; needed by the model papanastasiou"},
    {"FlowIndexWithoutAPower", slump_text, "plastic_viscosity = 50.0",
     "plastic_viscosity = 50.0\nflow_index = 0.5",
     "wrong.toml:16:14: material.flow_index is 0.5, which the model papanastasiou does not have; allowed: "
     "1, or only elasto-viscoplastic, herschel-bulkley as material.model and in runs"},
    {"FlowIndexOfNoConcrete", slump_text, "plastic_viscosity = 50.0",
     "plastic_viscosity = 50.0\nflow_index = 2",
     "wrong.toml:16:14: material.flow_index is 2; allowed: at least 0.3, at most 1.5"},
    {"NoCriticalShearRate", duct_text, "poisson_ratio = 0.45", "poisson_ratio = 0.45\nmodel = \"bi-viscous\"",
     "wrong.toml:5:2: material.critical_shear_rate is missing; needed by the model bi-viscous: "
     "critical_shear_rate or regularisation_time, of which it is"},
    {"NoBodyForce", duct_text, "body_force = [[0.0, 2000.0], [12.0, 360.0]]\n", "",
     "wrong.toml:11:2: forces.body_force is missing; needed: force along the duct: a constant, or pairs of "
     "the time from which it holds (s) and its value"},
    {"HalfOfThixotropy", slump_text, "[walls]", "[thixotropy]\nflocculation_rate = 0.4\n[walls]",
     "wrong.toml:19:2: thixotropy.deflocculation_coefficient is missing; needed: deflocculation coefficient "
     "alpha (Yu et al. 2026, Eq. 12) (number, at"},
    {"EmptyThixotropy", slump_text, "[walls]", "[thixotropy]\n[walls]",
     "wrong.toml:19:2: thixotropy.flocculation_rate is missing; needed: flocculation rate A_thix (Yu et al. "
     "2026, Eq. 12) (number, at least 0, at most"},
    {"NanIsNoNumber", slump_text, "density = 2300.0", "density = nan",
     "wrong.toml:13:11: material.density is nan; allowed: finite numbers, greater than 0, at most 1e+06"},
    {"InfiniteNumber", slump_text, "end = 60.0", "end = inf",
     "wrong.toml:24:7: time.end is inf; allowed: finite numbers, greater than 0, at most 1e+12"},
    {"NegativeInfinity", slump_text, "gravity = 9.81", "gravity = -inf",
     "wrong.toml:22:11: forces.gravity is -inf; allowed: finite numbers, at least 0, at most 100000"},
    {"NumberThatOverflows", slump_text, "density = 2300.0", "density = 1e400",
     "wrong.toml:13:16: is not valid TOML: Error while parsing floating-point: '1e400' could not be "
     "interpreted as a value"},
    {"IntegerThatOverflows", slump_text, "density = 2300.0", "density = 99999999999999999999",
     "wrong.toml:13:31: is not valid TOML: Error while parsing decimal integer: '99999999999999999999' is "
     "not representable in 64 bits"},
    {"NegativeDensity", slump_text, "density = 2300.0", "density = -2300.0",
     "wrong.toml:13:11: material.density is -2300; allowed: greater than 0, at most 1e+06"},
    {"NoMass", slump_text, "density = 2300.0", "density = 0",
     "wrong.toml:13:11: material.density is 0; allowed: greater than 0, at most 1e+06"},
    {"PoissonRatioOfAHalf", slump_text, "poisson_ratio = 0.3", "poisson_ratio = 0.5",
     "wrong.toml:17:17: material.poisson_ratio is 0.5; allowed: greater than 0, less than 0.5"},
    {"PoissonRatioOfZero", slump_text, "poisson_ratio = 0.3", "poisson_ratio = 0",
     "wrong.toml:17:17: material.poisson_ratio is 0; allowed: greater than 0, less than 0.5"},
    {"NegativePoissonRatio", slump_text, "poisson_ratio = 0.3", "poisson_ratio = -0.2",
     "wrong.toml:17:17: material.poisson_ratio is -0.2; allowed: greater than 0, less than 0.5"},
    {"NegativeYieldStress", slump_text, "yield_stress = 50", "yield_stress = -50",
     "wrong.toml:14:16: material.yield_stress is -50; allowed: at least 0, at most 1e+15"},
    {"NegativeViscosity", slump_text, "plastic_viscosity = 50.0", "plastic_viscosity = -1e-9",
     "wrong.toml:15:21: material.plastic_viscosity is -1e-09; allowed: at least 0, at most 1e+15"},
    {"NegativeModulus", slump_text, "youngs_modulus = 1.0e5", "youngs_modulus = -1.0e5",
     "wrong.toml:16:18: material.youngs_modulus is -100000; allowed: greater than 0, at most 1e+15"},
    {"NegativeRegularisationTime", slump_text, "regularisation_time = 100.0", "regularisation_time = -1",
     "wrong.toml:18:23: material.regularisation_time is -1; allowed: greater than 0, at most 1e+12"},
    {"CriticalShearRateOfZero", slump_text, "regularisation_time = 100.0",
     "regularisation_time = 100.0\ncritical_shear_rate = 0.0",
     "wrong.toml:19:23: material.critical_shear_rate is 0; allowed: greater than 0, at most 1e+12"},
    {"NegativeGravity", slump_text, "gravity = 9.81", "gravity = -9.81",
     "wrong.toml:22:11: forces.gravity is -9.81; allowed: at least 0, at most 100000"},
    {"NegativeFlocculation", slump_text, "[walls]",
     "[thixotropy]\nflocculation_rate = 0.4\ndeflocculation_coefficient = 0.1\ninitial_flocculation = "
     "-1\n[walls]",
     "wrong.toml:22:24: thixotropy.initial_flocculation is -1; allowed: at least 0, at most 1e+09"},
    {"BreakdownExponentOfZero", thixotropic_text, "[walls]", "breakdown_exponent = 0\n[walls]",
     "wrong.toml:23:22: thixotropy.breakdown_exponent is 0; allowed: greater than 0, at most 4"},
    {"NegativeAgeingRate", thixotropic_text, "[walls]", "ageing_rate = -0.1\n[walls]",
     "wrong.toml:23:15: thixotropy.ageing_rate is -0.1; allowed: at least 0, at most 1e+09"},
    {"AgeingTimeOfZero", thixotropic_text, "[walls]", "ageing_rate = 0.1\nageing_time = 0\n[walls]",
     "wrong.toml:24:15: thixotropy.ageing_time is 0; allowed: greater than 0, at most 1e+12"},
    {"BornInTheFuture", thixotropic_text, "[walls]", "ageing_rate = 0.1\ninitial_age = -60\n[walls]",
     "wrong.toml:24:15: thixotropy.initial_age is -60; allowed: at least 0, at most 1e+12"},
    {"NoTimeAtAll", slump_text, "end = 60.0", "end = 0",
     "wrong.toml:24:7: time.end is 0; allowed: greater than 0, at most 1e+12"},
    {"NegativeTime", slump_text, "end = 60.0", "end = -60.0",
     "wrong.toml:24:7: time.end is -60; allowed: greater than 0, at most 1e+12"},
    {"RestBoundOfZero", slump_text, "rest_bound = 0.006", "rest_bound = 0",
     "wrong.toml:26:14: time.rest_bound is 0; allowed: greater than 0, at most 1"},
    {"HistoryIntervalOfZero", slump_text, "history_interval = 0.05", "history_interval = 0",
     "wrong.toml:28:20: output.history_interval is 0; allowed: greater than 0, at most 1e+12"},
    {"NegativeSnapshotInterval", slump_text, "snapshot_interval = 1.0", "snapshot_interval = -1.0",
     "wrong.toml:30:21: output.snapshot_interval is -1; allowed: greater than 0, at most 1e+12"},
    {"NegativeCell", slump_text, "cell = 0.01\nparticles", "cell = -0.01\nparticles",
     "wrong.toml:34:8: mpm.cell is -0.01; allowed: greater than 0, at most 1e+06"},
    {"CflOfZero", slump_text, "cfl = 0.75", "cfl = 0.0",
     "wrong.toml:36:7: mpm.cfl is 0; allowed: greater than 0, at most 100"},
    {"NegativeThreads", slump_text, "cfl = 0.75", "threads = -1",
     "wrong.toml:36:11: mpm.threads is -1; allowed: 0 to 4096"},
    {"WideWedge", slump_text, "[foam]", "[foam]\nwedge_angle = 90",
     "wrong.toml:38:15: foam.wedge_angle is 90; allowed: greater than 0, at most 10"},
    {"ParticlesThatAreNoPower", slump_text, "particles_per_cell = 9", "particles_per_cell = 10",
     "wrong.toml:35:22: mpm.particles_per_cell is 10, neither a square nor a cube; allowed: for example 9, "
     "or an array with one entry for each axis"},
    {"TooManyParticlesAlongAnAxis", slump_text, "particles_per_cell = 9", "particles_per_cell = 289",
     "wrong.toml:35:22: mpm.particles_per_cell is 289, 17 along each axis; allowed: at most 16 along an "
     "axis"},
    {"ModulusThatUnderflows", duct_text, "bulk_modulus = 0.33e6", "bulk_modulus = 5e-324",
     "wrong.toml:9:16: material.bulk_modulus leads to a Young's modulus of 0; allowed: greater than 0"},
    {"RegularisationThatYieldsNowhere", slump_text, "regularisation_time = 100.0",
     "regularisation_time = 1e-13",
     "wrong.toml:18:23: material.regularisation_time leads to a critical shear rate of 1e+13; allowed: "
     "greater than 0"},
    {"NoParticles", slump_text, "particles_per_cell = 9", "particles_per_cell = 0",
     "wrong.toml:35:22: mpm.particles_per_cell is 0; allowed: 1 to 4096"},
    {"ParticlesForTooManyAxes", slump_text, "particles_per_cell = 9", "particles_per_cell = [3, 3, 3]",
     "wrong.toml:35:22: mpm.particles_per_cell has 3 entries; allowed: 2, one for each axis of a computation "
     "that is axisymmetric"},
    {"ParticlesForOneAxis", slump_text, "particles_per_cell = 9", "particles_per_cell = [9]",
     "wrong.toml:35:22: mpm.particles_per_cell has 1 entry; allowed: one number, or one entry for each axis "
     "(2 or 3)"},
    {"NoParticlesAlongAnAxis", slump_text, "particles_per_cell = 9", "particles_per_cell = [3, 0]",
     "wrong.toml:35:26: mpm.particles_per_cell along an axis is 0; allowed: 1 to 16"},
    {"HalfAParticle", slump_text, "particles_per_cell = 9", "particles_per_cell = 4.5",
     "wrong.toml:35:22: mpm.particles_per_cell must be an integer or an array of one integer for each axis, "
     "not a number"},
    {"ConeWiderThanTheDomain", slump_text, "domain_radius = 0.45", "domain_radius = 0.1",
     "wrong.toml:9:17: the cone does not fit the domain: its radius is 0.1 m, geometry.domain_radius is 0.1 "
     "m; allowed: a domain wider than the cone"},
    {"ConeHigherThanTheDomain", slump_text, "domain_height = 0.35", "domain_height = 0.29",
     "wrong.toml:10:17: the cone does not fit the domain: its height is 0.3 m, geometry.domain_height is "
     "0.29 m; allowed: a domain at least as high as the"},
    {"ConeWithoutHeight", slump_text, "cone_height = 0.3", "cone_height = 0.0",
     "wrong.toml:6:15: geometry.cone_height is 0; allowed: greater than 0, at most 1e+06"},
    {"CellLargerThanTheCone", slump_text, "cell = 0.01\nparticles", "cell = 0.2\nparticles",
     "wrong.toml:34:8: mpm.cell is 0.2 m, larger than the cone (0.1 m); allowed: at most 0.1"},
    {"MeshCellLargerThanTheCone", slump_text, "[foam]\ncell = 0.01", "[foam]\ncell = 0.2",
     "wrong.toml:38:8: foam.cell is 0.2 m, larger than the cone (0.1 m); allowed: at most 0.1"},
    {"ConeInADuct", duct_text, "height = 0.5", "height = 0.5\ncone_height = 0.3",
     "wrong.toml:5:15: geometry.cone_height does not belong to a duct; allowed in [geometry]: dimension, "
     "height"},
    {"PlatesInASlump", slump_text, "domain_height = 0.35", "domain_height = 0.35\nheight = 0.5",
     "wrong.toml:11:10: geometry.height does not belong to a slump; allowed in [geometry]: dimension, "
     "cone_height, cone_radius_top, cone_radius_bottom,"},
    {"GravityInADuct", duct_text, "[forces]", "[forces]\ngravity = 9.81",
     "wrong.toml:12:11: forces.gravity does not belong to a duct; allowed in [forces]: body_force"},
    {"BodyForceInASlump", slump_text, "gravity = 9.81", "gravity = 9.81\nbody_force = 1.0",
     "wrong.toml:23:14: forces.body_force does not belong to a slump; allowed in [forces]: gravity"},
    {"AxisymmetricDuct", duct_text, "height = 0.5", "height = 0.5\ndimension = \"axisymmetric\"",
     "wrong.toml:5:13: geometry.dimension is axisymmetric, which does not suit a duct; allowed: plane"},
    {"DuctOfAFractionOfACell", duct_text, "cell = 0.01", "cell = 0.03",
     "wrong.toml:16:8: the duct is 16.6667 cells high; allowed: a whole number of cells, for example "
     "mpm.cell = 0.0294118"},
    {"DuctBelowACell", duct_text, "cell = 0.01", "cell = 1",
     "wrong.toml:16:8: mpm.cell is 1 m, larger than the duct (0.5 m); allowed: at most 0.5"},
    {"BodyForceThatStartsLate", duct_text, "[[0.0, 2000.0], [12.0, 360.0]]", "[[1.0, 2000.0]]",
     "wrong.toml:12:16: forces.body_force starts at 1 s; allowed: pairs that start at time 0"},
    {"BodyForceThatGoesBack", duct_text, "[[0.0, 2000.0], [12.0, 360.0]]",
     "[[0.0, 1.0], [2.0, 1.0], [2.0, 3.0]]",
     "wrong.toml:12:40: forces.body_force goes from 2 s to 2 s; allowed: ascending times"},
    {"EmptyBodyForce", duct_text, "[[0.0, 2000.0], [12.0, 360.0]]", "[]",
     "wrong.toml:12:14: forces.body_force has 0 pairs; allowed: 1 to 10000"},
    {"BodyForceOfSingles", duct_text, "[[0.0, 2000.0], [12.0, 360.0]]", "[0.0, 2000.0]",
     "wrong.toml:12:15: forces.body_force must hold pairs of two numbers, [time, force]"},
    {"BodyForceOfWords", duct_text, "[[0.0, 2000.0], [12.0, 360.0]]", "[[0.0, \"strong\"]]",
     "wrong.toml:12:21: forces.body_force at a force must be a number, not a string"},
    {"BodyForceThatIsInfinite", duct_text, "[[0.0, 2000.0], [12.0, 360.0]]", "[[0.0, inf]]",
     "wrong.toml:12:21: forces.body_force at a force is inf; allowed: finite numbers, at least -1e+15, at "
     "most 1e+15"},
    {"BodyForceOfTriples", duct_text, "[12.0, 360.0]", "[12.0, 360.0, 1.0]",
     "wrong.toml:12:30: forces.body_force must hold pairs of two numbers, [time, force]"},
    {"BodyForceBeforeTime", duct_text, "[12.0, 360.0]", "[-12.0, 360.0]",
     "wrong.toml:12:31: forces.body_force at a time is -12; allowed: at least 0, at most 1e+12"},
    {"ThreadsThatAreMany", slump_text, "cfl = 0.75", "threads = 1000000",
     "wrong.toml:36:11: mpm.threads is 1000000; allowed: 0 to 4096"},
    {"NegativeSeed", slump_text, "cfl = 0.75", "seed = -1",
     "wrong.toml:36:8: mpm.seed is -1; allowed: 0 to 9223372036854775807"},
    {"SeedThatIsNoInteger", slump_text, "cfl = 0.75", "seed = 1.0",
     "wrong.toml:36:8: mpm.seed must be an integer, not a number"},
    {"NegativeAirDensity", slump_text, "[foam]", "[foam]\nair_density = -1",
     "wrong.toml:38:15: foam.air_density is -1; allowed: greater than 0, at most 1e+06"},
    {"ScalesPastAnyBody", slump_text, "domain_radius = 0.45", "domain_radius = 1e7",
     "wrong.toml:9:17: geometry.domain_radius is 1e+07; allowed: greater than 0, at most 1e+06"},
    {"ModulusOfZero", slump_text, "youngs_modulus = 1.0e5", "youngs_modulus = 0",
     "wrong.toml:16:18: material.youngs_modulus is 0; allowed: greater than 0, at most 1e+15"},
    {"UnknownSeeding", slump_text, "cfl = 0.75", "seeding = \"random\"",
     "wrong.toml:36:11: mpm.seeding is \"random\"; allowed: lattice, jittered, gmsh"},
    {"UnknownFluidUpdate", slump_text, "cfl = 0.75", "fluid_update = \"implict\"",
     "wrong.toml:36:16: mpm.fluid_update is \"implict\", nearest is \"implicit\"; allowed: implicit, "
     "explicit"},
    {"UnknownBBar", slump_text, "cfl = 0.75", "b_bar = \"smoth\"",
     "wrong.toml:36:9: mpm.b_bar is \"smoth\", nearest is \"smooth\"; allowed: smooth, cell-average"},
    {"SmoothBBarOfLinearFunctions", slump_text, "scheme = \"quadratic-apic\"",
     "b_bar = \"smooth\"\nscheme = \"linear-flip\"",
     "wrong.toml:33:9: mpm.b_bar is smooth, with the scheme linear-flip; allowed: cell-average, or the "
     "scheme "
     "quadratic-apic"},
    {"BBarOfThePaper", slump_text, "scheme = \"quadratic-apic\"",
     "b_bar = \"cell-average\"\nscheme = \"paper\"",
     "wrong.toml:33:9: mpm.b_bar is cell-average, with the scheme paper; allowed: none, for it takes the "
     "strain "
     "at the cell's centre, or the scheme quadratic-apic"},
    {"ExtendsAnUnknownScene", slump_text, "kind = \"slump\"", "kind = \"slump\"\nextends = \"no-such-scene\"",
     "wrong.toml:3:11: unknown scene \"no-such-scene\"; allowed: a path to a .toml file, or "},
    {"BodyForceNestedTooDeeply", duct_text, "[[0.0, 2000.0], [12.0, 360.0]]", "[[0.0, [1.0]]]",
     "wrong.toml:12:21: forces.body_force at a force must be a number, not an array nested too deeply"},
    {"BodyForceGivenAsString", duct_text, "[[0.0, 2000.0], [12.0, 360.0]]", "\"strong\"",
     "wrong.toml:12:14: forces.body_force must be a number or an array of [time, force] pairs, not a string"},
    {"TwoModuli", slump_text, "youngs_modulus = 1.0e5", "youngs_modulus = 1.0e5\nbulk_modulus = 1e5",
     "wrong.toml:17:16: material.bulk_modulus and material.youngs_modulus are both given; allowed: one of "
     "them, the other follows from the Poisson ratio"},
    {"MaterialCrushedByItsFall", slump_text, "youngs_modulus = 1.0e5", "youngs_modulus = 1",
     "wrong.toml:16:18: the material is so soft that a fall from its own height ends at 2.43 m/s, faster "
     "than "
     "sound in it (0.0242 m/s): it would be crushed; allowed: moduli at least 1.01e+04 times as large, or "
     "less "
     "gravity"},
    {"SoftBulkCrushedByItsFall", slump_text, "youngs_modulus = 1.0e5", "bulk_modulus = 1",
     "wrong.toml:16:16: the material is so soft that a fall from its own height ends at 2.43 m/s"},
    {"AHundredTimesTheGravity", slump_text, "gravity = 9.81", "gravity = 981",
     "wrong.toml:16:18: the material is so soft that a fall from its own height ends at 24.3 m/s"},
    {"ThixotropyWithoutYieldStress", thixotropic_text, "yield_stress = 50", "yield_stress = 0",
     "wrong.toml:14:16: the yield stress is 0, but flocculation grows at flocculation_rate / yield_stress; "
     "allowed: a yield stress greater than 0 in scenes"},
    {"AgeingTimeWithoutRate", thixotropic_text, "[walls]", "ageing_time = 3000\n[walls]",
     "wrong.toml:23:15: thixotropy.ageing_time is given without thixotropy.ageing_rate, of which it says how "
     "it goes on; allowed: both, or neither"},
    {"AgeWithoutRate", thixotropic_text, "[walls]", "initial_age = 600\n[walls]",
     "wrong.toml:23:15: thixotropy.initial_age is given without thixotropy.ageing_rate, of which it says how "
     "it goes on; allowed: both, or neither"},
    {"SetBeforeItsEnd", thixotropic_text, "[walls]", "ageing_rate = 0.1\nageing_time = 2\n[walls]",
     "wrong.toml:24:15: the yield stress grows with age by 2.14e+12 Pa until time.end; allowed: at most "
     "1e+09 Pa, with a smaller thixotropy.ageing_rate or initial_age, or a longer ageing_time"},
    {"AgeThatOverflows", thixotropic_text, "[walls]",
     "ageing_rate = 0.1\nageing_time = 1\ninitial_age = 1e6\n[walls]",
     "wrong.toml:24:15: the yield stress grows with age by inf Pa until time.end"},
    {"InviscidInOpenFoam", slump_text, "plastic_viscosity = 50.0", "plastic_viscosity = 0",
     "wrong.toml:15:21: material.plastic_viscosity is 0, on which the step of a fluid in OpenFOAM depends; "
     "allowed: greater than 0 or foam.max_time_step where runs.foam names a fluid"},
    {"StepPastTheAcousticLimit", slump_text, "cfl = 0.75", "time_step = 0.0013",
     "wrong.toml:36:13: mpm.time_step of 0.0013 s is past the acoustic limit of 0.00120022 s (1.15 cell / c, "
     "with cell = 0.01 m and c = 9.5816 m/s under"},
    {"CflPastTheAcousticLimit", slump_text, "cfl = 0.75", "cfl = 1.2",
     "wrong.toml:36:7: mpm.cfl is 1.2, past the acoustic limit of 1.15 at a Poisson ratio of 0.3; allowed: "
     "at most 1.15, or mpm.allow_unstable_step = true"},
    {"PaperStepPastTheAcousticLimit", slump_text, "scheme = \"quadratic-apic\"\ncell = 0.01",
     "scheme = \"paper\"\ncell = 0.0025",
     "wrong.toml:33:10: the time step of the scheme paper of 0.0005 s is past the acoustic limit of "
     "0.000300054 s (1.15 cell / c, with cell = 0.0025 m and"},
    {"StepPastTheViscousLimit", fluid_text, "cfl = 0.75", "time_step = 5e-4\nfluid_update = \"explicit\"",
     "wrong.toml:36:13: the time step of 0.0005 s is past the viscous limit of 7.59076e-06 s of an explicit "
     "papanastasiou fluid (density cell^2 / (6"},
    {"MoreParticlesThanAMachineHolds", slump_text, "cell = 0.01\nparticles", "cell = 1e-6\nparticles",
     "wrong.toml:34:8: mpm.cell is 1e-06 m: the scene would have 2.02e+11 particles; allowed: at most 2e+09"},
    {"CellThatUnderflows", slump_text, "cell = 0.01\nparticles", "cell = 1e-300\nparticles",
     "wrong.toml:34:8: mpm.cell is 1e-300 m: the scene would have inf particles; allowed: at most 2e+09"},
    {"MeshThatNoMachineHolds", slump_text, "[foam]\ncell = 0.01", "[foam]\ncell = 1e-6",
     "wrong.toml:38:8: the OpenFOAM mesh would have 1.58e+11 cells of 1e-06 m; allowed: at most 2e+09"},
    {"MoreStepsThanALifetimeHolds", fine_text, "end = 60.0", "end = 1e6",
     "wrong.toml:24:7: the run would take 6.39e+11 steps of 5.06e+08 particles; allowed: at most 1e+18 "
     "particle-steps"},
    {"MoreOutputsThanADiskHolds", slump_text, "history_interval = 0.05", "history_interval = 1e-9",
     "wrong.toml:28:20: output.history_interval is 1e-09 s: there would be 6e+10 outputs; allowed: at most "
     "1e+08"},
};

class WrongScene : public testing::TestWithParam<Wrong> {};

TEST_P(WrongScene, IsRefusedWithItsMessage) {
  const Wrong& wrong = GetParam();
  EXPECT_THAT(complaint(replaced(wrong.text, wrong.from, wrong.to)), testing::HasSubstr(wrong.message));
}

INSTANTIATE_TEST_SUITE_P(Scenes, WrongScene, testing::ValuesIn(wrong_scenes),
                         [](const auto& instance) { return std::string(instance.param.name); });

TEST(WrongScenes, TheScenesTheyAreMadeOfAreRight) {
  for (const std::string& text : {slump_text, duct_text, fluid_text, thixotropic_text, fine_text}) {
    EXPECT_EQ(complaint(text), "");
  }
}

TEST(WrongScenes, AllFaultsAreReportedInTheOrderOfTheText) {
  std::string text = replaced(slump_text, "density = 2300.0", "density = -1");
  text = replaced(text, "poisson_ratio = 0.3", "poisson_ratio = 0.5");
  text = replaced(text, "domain_radius = 0.45", "domain_radius = 0.05");
  text = replaced(text, "cfl = 0.75", "clf = 0.75");
  EXPECT_THAT(complaint(text), testing::MatchesRegex("wrong.toml:9:17: the cone does not fit[^\n]*\n"
                                                     "wrong.toml:13:11: material.density is -1[^\n]*\n"
                                                     "wrong.toml:17:17: material.poisson_ratio is 0.5[^\n]*\n"
                                                     "wrong.toml:36:1: unknown key \"mpm.clf\"[^\n]*"));
}

TEST(WrongScenes, AFaultHidesNoOtherAndInventsNone) {
  // The step limits depend on the density: without it nothing is said about them.
  std::string text = replaced(slump_text, "density = 2300.0", "density = \"heavy\"");
  text = replaced(text, "cfl = 0.75", "time_step = 1.0");
  EXPECT_EQ(complaint(text), "wrong.toml:13:11: material.density must be a number, not a string");
}

TEST(WrongScenes, AHostOfFaultsIsCutShort) {
  std::string text = slump_text;
  for (int i = 0; i < 1000; ++i) text += "unknown_" + std::to_string(i) + " = 1\n";
  const std::string message = complaint(text);
  EXPECT_THAT(message, testing::HasSubstr("... and 950 more faults"));
  EXPECT_LT(message.size(), 20000u);
}

TEST(WrongScenes, HostileTextIsQuotedOnOneLine) {
  const std::string message = complaint(slump_text + "\"a\\nb\\u0007\" = 1\n");
  EXPECT_THAT(message, testing::HasSubstr(R"(wrong.toml:39:1: unknown key "foam.a\x0ab\x07")"));
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(WrongScenes, DeepNestingIsRefusedBeforeItCostsTheStack) {
  for (const std::string& opening : {std::string("["), std::string("{a=")}) {
    std::string text = "a = ";
    for (int i = 0; i < 100000; ++i) text += opening;
    EXPECT_THAT(complaint(text), testing::HasSubstr("exceeded maximum nested value depth"));
  }
  std::string dotted;
  for (int i = 0; i < 200000; ++i) dotted += "a.";
  EXPECT_THAT(complaint(dotted + "a = 1"), testing::HasSubstr("wrong.toml:1:1: has more than 10000 dots"));
  EXPECT_THAT(complaint("[" + dotted + "a]"), testing::HasSubstr("wrong.toml:1:1: has more than 10000 dots"));
}

TEST(WrongScenes, ATextInUtf16IsNamedAsSuch) {
  std::string marked = "\xFF\xFE", unmarked;
  for (const char c : slump_text) {
    marked += {c, '\0'};
    unmarked += {'\0', c};
  }
  for (const std::string& text : {marked, unmarked})
    EXPECT_EQ(complaint(text),
              "wrong.toml:1:1: is text in UTF-16; allowed: text in UTF-8 (a spreadsheet calls it CSV UTF-8)");
  EXPECT_THAT(complaint(slump_text + '\0'), testing::HasSubstr("holds bytes that are 0, so it is no text"));
}

TEST(WrongScenes, ATextOfMoreThanAMegabyteIsRefused) {
  EXPECT_THAT(complaint(slump_text + "# " + std::string(1 << 20, 'x')),
              testing::HasSubstr("wrong.toml:1:1: is 1049320 bytes long; allowed: 1048576"));
}

TEST(WrongScenes, AGaugeIsReadWithinTheBodyThatHasIt) {
  EXPECT_THAT(complaint(slump_text, {{"gauges.spread_depth=0.3"}, {}}),
              testing::HasSubstr(
                  "gauges.spread_depth is 0.3 m, and the cone's height is 0.3 m; allowed: less than that"));
  EXPECT_THAT(complaint(slump_text, {{"gauges.spread_depth=0"}, {}}),
              testing::HasSubstr("gauges.spread_depth is 0; allowed: greater than 0"));
  EXPECT_THAT(
      complaint(slump_text, {{"gauges.front_depth=0.003"}, {}}),
      testing::HasSubstr(
          "gauges.front_depth does not belong to a slump; allowed in [gauges]: spread_depth, rest_rate"));
  EXPECT_THAT(complaint(duct_text, {{"gauges.spread_depth=0.003"}, {}}),
              testing::HasSubstr("gauges.spread_depth does not belong to a duct"));
}

}  // namespace
}  // namespace flowrest::scenes::test
