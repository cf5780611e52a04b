#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "scenes/apparatus/apparatus.h"
#include "scenes/choices.h"

/// The scene: what is simulated, read from TOML, checked and resolved once for every solver, in SI units.
namespace flowrest::scenes {

struct Geometry {
  Dimension dimension = Dimension::axisymmetric;
  Apparatus apparatus;
  bool operator==(const Geometry&) const = default;
};

struct Material {
  Model model = Model::elasto_viscoplastic;
  double density = 0.0;            ///< kg/m3, at rest and without pressure
  double yield_stress = 0.0;       ///< Pa, tau0
  double plastic_viscosity = 0.0;  ///< Pa s, eta; where flow_index is not 1 the consistency K, Pa s^n
  double flow_index = 1.0;         ///< n, the power of the shear rate
  double youngs_modulus = 0.0;     ///< Pa, E; resolved from bulk_modulus where that is given instead
  double poisson_ratio = 0.0;      ///< nu
  double equation_of_state_exponent = 7.0;    ///< gamma of Yu et al. 2026, Eq. 6
  std::optional<double> regularisation_time;  ///< s, m of Papanastasiou
  /// 1/s, where the bi-viscous law yields; resolved to 1/m where only the regularisation time is given.
  std::optional<double> critical_shear_rate;

  double bulk_modulus() const;        ///< K0 = E / (3 (1 - 2 nu)), Pa
  double shear_modulus() const;       ///< G0 = E / (2 (1 + nu)), Pa
  double longitudinal_speed() const;  ///< sqrt((K0 + 4 G0 / 3) / density), m/s
  /// Whether it has a parameter that a law may need.
  bool has(laws::Parameter) const;
  /// Whether it has all that a law needs.
  bool suits(Model) const;
  /// Its law in steady shear; a parameter that it does not have is 0, a critical shear rate 1.
  laws::FlowCurve flow_curve() const;
  bool operator==(const Material&) const = default;
};

/// Roussel's structural build-up and breakdown, Yu et al. 2026, Eqs. 11 and 12, and growth with age after Perrot
/// et al. 2016 (laws/structure.h).
struct Thixotropy {
  double flocculation_rate = 0.0;           ///< A_thix, Pa/s
  double deflocculation_coefficient = 0.0;  ///< alpha, s^(breakdown_exponent - 1)
  double initial_flocculation = 0.0;        ///< lambda0
  double breakdown_exponent = 1.0;          ///< m, the power of the shear rate by which flow breaks down
  double ageing_rate = 0.0;                 ///< Pa/s, of the yield stress that flow does not take back
  std::optional<double> ageing_time;        ///< s, t_c of its exponential growth; without it is linear
  double initial_age = 0.0;                 ///< s, of the concrete at the start

  laws::Structure<double> structure(double yield_stress) const {
    return {flocculation_rate / yield_stress, deflocculation_coefficient, breakdown_exponent};
  }
  laws::Ageing<double> ageing() const {
    return {ageing_rate, ageing_time ? 1.0 / *ageing_time : 0.0, initial_age};
  }
  bool operator==(const Thixotropy&) const = default;
};

/// What a wall does to the material that touches it.
struct WallContact {
  Wall law = Wall::no_slip;
  double friction = 0.0;  ///< Coulomb's coefficient, of Wall::friction
  bool operator==(const WallContact&) const = default;
};

struct Forces {
  double gravity = 0.0;  ///< m/s2, downwards
  /// (from time s, N/m3) along x, ascending in time; empty where nothing but gravity drives.
  std::vector<std::pair<double, double>> body_force;
  double body_force_at(double time) const;
  bool operator==(const Forces&) const = default;
};

struct Time {
  double end = 0.0;           ///< s
  bool stop_at_rest = true;   ///< EVP only: a fluid is never at rest
  double rest_bound = 0.006;  ///< bound on the relative growth of the spread still to come
  bool operator==(const Time&) const = default;
};

/// Simulated seconds between outputs.
struct Output {
  double history_interval = 0.05;
  double profile_interval = 0.25;
  double snapshot_interval = 1.0;
  double checkpoint_interval = 5.0;
  bool operator==(const Output&) const = default;
};

/// What gauges are defined by. The values here are those of the standard apparatus (an Abrams cone; an L-box,
/// a V-funnel and a tank of 600 mm); where a scene does not give them they scale with its body.
struct Gauges {
  double spread_depth = 0.003;    ///< m, of a slump where its spread is read
  double front_depth = 0.003;     ///< m, of what runs along a channel where its front is read
  double end_length = 0.02;       ///< m, of a channel's ends, over which the depth there is averaged
  double light_depth = 0.003;     ///< m of material on a line of sight that still hides the light
  double rest_rate = 5e-4;        ///< m/s: growth of spread or front that is customarily taken for rest
  double still_speed = 1e-4;      ///< m/s: a law that can rest, and grows by less, has come to rest
  double rest_shear_rate = 0.05;  ///< 1/s, customarily taken for rest
  double rate_window = 2.0;       ///< s, over which growth is taken
  /// The depth at which a gauge finds its edge, m; of velocities, which have none, the standard one.
  double edge_depth(MainGauge) const;
  bool operator==(const Gauges&) const = default;
};

/// What gauges are defined by, each under the name of its key.
inline constexpr std::pair<const char*, double Gauges::*> gauge_settings[] = {
    {"spread_depth", &Gauges::spread_depth},
    {"front_depth", &Gauges::front_depth},
    {"end_length", &Gauges::end_length},
    {"light_depth", &Gauges::light_depth},
    {"rest_rate", &Gauges::rest_rate},
    {"still_speed", &Gauges::still_speed},
    {"rest_shear_rate", &Gauges::rest_shear_rate},
    {"rate_window", &Gauges::rate_window}};

struct Mpm {
  Scheme scheme = Scheme::quadratic_apic;
  double cell = 0.0;  ///< m
  /// Particles per cell: along each axis (dimension of the scene long). A single number n in the scene is
  /// split evenly and must be a perfect power; an array gives each axis.
  std::vector<int> particles_per_cell;
  double cfl = 0.75;                 ///< Courant number of the acoustic step
  std::optional<double> time_step;   ///< s, fixed instead of CFL-controlled; `paper` sets 5e-4
  bool allow_unstable_step = false;  ///< lets time_step or cfl pass the stable limit
  Precision precision = Precision::double_precision;
  int threads = 0;  ///< 0: as many as the particles can feed, of the cores that are ours
  Seeding seeding = Seeding::lattice;
  std::uint64_t seed = 1;  ///< of the jitter
  FluidUpdate fluid_update = FluidUpdate::implicit_update;
  std::optional<BBar> b_bar;                   ///< cell_average in ducts and for `linear-flip`, else smooth
  double flip_relaxation_time = 0.05;          ///< s, of `linear-flip`
  std::optional<double> apic_relaxation_time;  ///< s, of `quadratic-apic`: its transfer acts once over this
  /// Share of an overlap of particles, or of a gap at a no-slip plane wall, taken back per unit strain; 1 for
  /// `quadratic-apic`, 0.3 for `linear-flip`, whose filling is noisier, 0 for `paper` and in ducts.
  std::optional<double> density_correction;
  bool operator==(const Mpm&) const = default;
};

struct Foam {
  double cell = 0.0;                      ///< m
  double max_courant = 0.25;              ///< bound on the Courant number of flow and interface
  std::optional<double> max_time_step;    ///< s; default cell^2 density / plastic_viscosity
  double step_growth = 16.0;              ///< by which a slump's step may outgrow its bound once it is slow
  double air_density = 1.0;               ///< kg/m3
  double air_kinematic_viscosity = 1e-2;  ///< m2/s, tames air jets at no cost in spread
  double wedge_angle = 5.0;               ///< degrees, the whole wedge
  /// Rows into which a slump's lowest row of cells is cut; 0: 4 with the plug-in (they need air that rises),
  /// else 1.
  int base_rows = 0;
  /// m, how far up rows are as thin as the lowest. Unless given: with the plug-in and about an axis as deep as
  /// the deposit, else one row.
  std::optional<double> base_height;
  /// s, in which air under concrete rises, 0: never; 0.1 with the plug-in, which does it.
  std::optional<double> air_rise_time;
  int outer_correctors = 1;  ///< how often a step is computed anew with what it has found
  FoamLaws laws = FoamLaws::best;
  FoamMixing mixing = FoamMixing::arithmetic;
  double full_at = 0.5;  ///< of `saturating`: the fraction of concrete from which its stress counts in full
  FoamWetting wetting = FoamWetting::geometric;
  FoamFaces face_weight = FoamFaces::linear;
  FoamStrainRate strain_rate = FoamStrainRate::concrete;
  bool operator==(const Foam&) const = default;
};

/// Which runs `flowrest run` makes of this scene.
struct Runs {
  std::vector<Model> mpm;
  std::vector<Model> foam;
  bool exact = false;
  bool elements = false;  ///< the referee of a slump, by finite elements
  std::string from;       ///< the state that they start from; empty: the scene's body
  bool operator==(const Runs&) const = default;
};

/// What the command line lays over a scene.
struct Overrides {
  std::vector<std::string>
      set;                     ///< "material.yield_stress=100": TOML values; a word may stand without quotes
  std::optional<Model> model;  ///< --model
};

/// How a scene was asked for: what a command needs to ask for it again.
struct Request {
  std::string scene;           ///< as it was named: a name, or the path of a file
  std::filesystem::path file;  ///< that it was read from, absolute
  Overrides overrides;
};

struct Scene {
  std::string name;            ///< file name without extension
  std::filesystem::path path;  ///< the file it was read from
  std::string source;          ///< the file's text, as read
  Request request;
  std::string title;
  Runs runs;
  Geometry geometry;
  Material material;
  std::optional<Thixotropy> thixotropy;
  WallContact base;                  ///< of the plate, the plates or the whole container
  std::optional<WallContact> mould;  ///< as `base` where it is not given
  Forces forces;
  Time time;
  Output output;
  Gauges gauges;
  Mpm mpm;
  Foam foam;

  const Slump& slump() const { return std::get<Slump>(geometry.apparatus); }
  const Duct& duct() const { return std::get<Duct>(geometry.apparatus); }
  const LBox& l_box() const { return std::get<LBox>(geometry.apparatus); }
  const VFunnel& v_funnel() const { return std::get<VFunnel>(geometry.apparatus); }
  const Printing& printing() const { return std::get<Printing>(geometry.apparatus); }
  const DamBreak& dam_break() const { return std::get<DamBreak>(geometry.apparatus); }
  MainGauge main_gauge() const;
  /// What the yield stress has grown by with age at a time in s, Pa; 0 where nothing ages.
  double grown_yield_stress(double when) const;
  /// The same over tau0: with lambda the part by which the local yield stress passes tau0.
  double grown_over_yield_stress(double when) const {
    const double grown = grown_yield_stress(when);
    return grown > 0.0 ? grown / material.yield_stress : 0.0;
  }
  /// Of a place that is flocculated so at a time in s, Pa.
  double local_yield_stress(double flocculation, double when) const {
    return (1.0 + flocculation) * material.yield_stress + grown_yield_stress(when);
  }
  /// Height of the material at the start, m.
  double body_height() const;
  /// By which lengths are carried from one body to another, m: its height, or of a cone the root of its volume.
  double body_size() const;
  /// Spatial dimension of the computation: 2 for axisymmetric and plane, 3 for the others.
  int spatial_dimension() const {
    return geometry.dimension == Dimension::axisymmetric || geometry.dimension == Dimension::plane ? 2 : 3;
  }
};

/// What gauges are defined by in a scene that does not say: lengths in proportion to the body's height,
/// speeds to the root of height times gravity. A duct has the standard values.
Gauges gauges_of_body(const Scene&);

/// A scene that cannot be used. what() holds one line per fault: "file:line:column: what is wrong; what is
/// allowed".
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What a command line gives with --set and --model (empty: none), each key once.
/// @throws SceneError where a setting would take the place of another one, or --model that of one, unseen.
Overrides overrides_of_command_line(const std::vector<std::string>& set, const std::string& model = "");

/// Whether a command line's settings give this key.
bool gives_key(const std::vector<std::string>& set, const std::string& path);

/// Reads, resolves and checks a scene. `named` is a path or the name of a file in the scenes folder.
/// @throws SceneError naming every fault found, never only the first.
Scene load_scene(const std::string& named, const Overrides& overrides = {});

/// Whether a scene is named by the path of its file, not by its name.
bool is_path(const std::string& named);

/// As load_scene, of a text held in memory; `path` only names it in messages.
Scene parse_scene(const std::string& text, const std::filesystem::path& path,
                  const Overrides& overrides = {});

/// The resolved settings as TOML: parse_scene of it gives the same scene.
std::string resolved_toml(const Scene&);

/// The resolved settings as JSON text with the same keys.
std::string resolved_json(const Scene&);

/// For commands that run what a scene's `runs` name.
/// @throws SceneError where `set` gives material.model, which `runs` overrules.
void check_model_has_effect(const Scene&, const std::vector<std::string>& set);

struct SceneSummary {
  std::string name;
  std::string title;
  std::string error;  ///< the first fault, where the scene cannot be read
};
/// Every scene in the scenes folder, by name.
std::vector<SceneSummary> list_scenes();

/// FLOWREST_SCENES where set, else the scenes that flowrest brings.
std::filesystem::path scenes_folder();

/// @throws SceneError naming the allowed names and the nearest one.
Model model_from_name(const std::string&);

}  // namespace flowrest::scenes
