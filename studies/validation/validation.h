#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/measures/series.h"
#include "compare/report/page.h"
#include "compare/words.h"
#include "runs/verdict.h"
#include "studies/job.h"
#include "studies/validation/published.h"
#include "studies/workflow.h"

namespace CLI {
class App;
}

/// The papers' scenes, each run at two resolutions in every solver and law that it names, against published
/// numbers. The runs are jobs of a study's workflow.
namespace flowrest::studies::validation {

struct Options {
  std::vector<std::string> scenes = {};  ///< empty: every scene of scenes/papers.csv
  std::vector<std::string> set = {};     ///< laid over all of them
  std::optional<scenes::Model> model = {};
  std::optional<Solver> solver = {};  ///< only its runs
  double coarsening = 4.0 / 3.0;      ///< the second resolution's cells over the scene's
  bool any_version = false;           ///< runs of other versions of flowrest are taken too
  std::filesystem::path folder = "out/validation";
};

/// A run that is wanted.
struct Wanted {
  Solver solver = Solver::mpm;
  scenes::Model model = scenes::Model::elasto_viscoplastic;
  bool coarse = false;  ///< of the second resolution
  double cell = 0.0;    ///< m
  Point point = {};
  std::string label() const;  ///< "MPM elasto-viscoplastic"
};

/// A scene and the runs that are wanted of it.
struct SceneWanted {
  std::string name = {};
  scenes::Scene scene = {};
  std::vector<Wanted> runs = {};
  std::vector<Published> published = {};
  std::string left_out = {};  ///< runs that this build cannot make, and why; empty where there are none
};

/// What is to be run, and what it is held against. Nothing is written.
/// @throws scenes::SceneError where a scene or a setting is refused; runs::RunError where a table is
/// malformed.
std::vector<SceneWanted> plan(const Options&);

/// Every point of the plan, for the workflow.
std::vector<Point> points_of(const std::vector<SceneWanted>&);

enum class Verdict { agrees, misses, unresolved, never, incomplete, not_run, not_comparable };
std::string to_string(Verdict);

/// A published number and what one solver and law make of it.
struct Number {
  Published published = {};
  Solver solver = Solver::mpm;
  scenes::Model model = scenes::Model::elasto_viscoplastic;
  std::optional<double> ours = {};         ///< at the scene's resolution
  std::optional<double> coarse = {};       ///< at the second one
  std::optional<double> uncertainty = {};  ///< of ours, by the two: taken on to zero cell size at first order
  /// Where a wall ends what is measured, such as an L-box's front; what gets there would have gone on.
  std::optional<double> wall = {};
  Verdict verdict = Verdict::not_run;
  std::optional<bool> within =
      {};                  ///< whether ours itself lies within what is allowed, however well it is known
  std::string words = {};  ///< the verdict in full
  runs::Doubt doubt = {};  ///< of the run's own verdict
  std::string walls_differ = {};     ///< what walls the run does not have as the scene has them, in words
  compare::words::Grain grain = {};  ///< the least that is told of its scene's lengths and times
  std::optional<double> difference() const;
};

/// Judges ours against the target.
void judge(Number&);

/// What the fluid's perpetual flow makes of a scene in one solver: its gauge when the solid comes to rest,
/// and later.
struct Perpetual {
  Solver solver = Solver::mpm;
  scenes::Model fluid = scenes::Model::papanastasiou;
  std::optional<double> rest = {};   ///< s, of the solid; none: it does not come to rest
  std::optional<double> solid = {};  ///< its gauge then, in the figures' unit
  double from = 0.0;                 ///< s: the solid's rest; where there is none, half of the fluid's time
  std::vector<std::pair<double, double>> fluid_at =
      {};  ///< time (s) and gauge: then, at twice and five times that, at the end
  /// What another choice of the stopping time would have changed: from `from` to the end.
  std::optional<double> change() const;
};

/// How the mean flocculation state goes in one run.
struct Flocculation {
  Solver solver = Solver::mpm;
  scenes::Model model = scenes::Model::elasto_viscoplastic;
  double start = 0.0, least = 0.0, least_at = 0.0, end = 0.0, end_at = 0.0;
  double rate_end = 0.0;      ///< 1/s, over the last fifth of the run
  bool held = false;          ///< the run ended at rest
  double growth_at_rest = 0;  ///< 1/s, of the law without flow: it goes on from the run's end
  bool rises_only = false;    ///< fresh concrete has no flocs to break: nothing falls
};

/// A run as found.
struct Found {
  Wanted wanted = {};
  Outcome outcome = {};
  std::string label = {};                     ///< with its cells
  std::string trouble = {};                   ///< as comparisons have it
  runs::Doubt doubt = {};                     ///< of the run's own verdict
  std::string walls_differ = {};              ///< in words
  std::string version = {};                   ///< of flowrest, that made it
  std::optional<double> rest = {}, end = {};  ///< s
  std::optional<double> gauge_end = {};       ///< in the figures' unit
  std::optional<double> arrival = {};         ///< s, at the end wall
  std::optional<double> creep = {};  ///< mm/s over the last fifth: of the gauge, or of the height at the end
                                     ///< wall once the front has arrived there
  double cpu = 0.0;                  ///< s
};

/// What the papers say of flow and rest beyond their numbers, and whether a run bears it out.
struct Finding {
  enum class Holds { yes, no, undecided, not_run };
  std::string claim = {};   ///< "the fluid does not stop"
  std::string source = {};  ///< "Yu Table 3, Fig. 20"
  std::string scene = {};   ///< or several: "six V-funnels"
  Solver solver = Solver::mpm;
  std::string law = {};  ///< a model, or "both laws"
  Holds holds = Holds::not_run;
  std::string seen = {};  ///< what the runs do, in words
};
std::string to_string(Finding::Holds);

/// All that is known of one scene.
struct SceneFound {
  std::string name = {}, title = {};
  const compare::ApparatusReport* apparatus = nullptr;
  scenes::Gauges gauges = {};            ///< what its gauges are defined by
  std::optional<double> length_mm = {};  ///< of a channel before whose end the front may stop
  std::vector<Found> runs = {};
  std::vector<Number> numbers = {};
  std::vector<Perpetual> perpetual = {};
  std::vector<Flocculation> flocculation = {};
  std::vector<report::Block> figures = {};  ///< their entries are those of `entries`
  std::vector<std::string> notes = {};      ///< warnings, in words
  std::string how_to_make = {};  ///< the command for the runs that are missing; empty where none is
};

struct Validation {
  std::vector<report::Entry> entries = {};  ///< a solver and a law each
  std::vector<SceneFound> scenes = {};
  std::vector<PaperItem> items = {};
  std::vector<Finding> findings = {};
};

/// What is found of the papers' claims, claim by claim. Runs of the second resolution bear nothing out.
std::vector<Finding> findings_of(const std::vector<SceneFound>&);

/// Reads whatever runs there are.
Validation collect(const Folder&, const std::vector<SceneWanted>&, const Options&);

nlohmann::ordered_json to_json(const Validation&);
std::string to_csv(const Validation&);
report::Page page_of(const Validation&);

/// Writes index.html, validation.json and validation.csv.
void write(const Validation&, const std::filesystem::path& folder);

void add_command(CLI::App&);

}  // namespace flowrest::studies::validation
