#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenes/cost.h"
#include "scenes/scene.h"
#include "scenes/value.h"

/// A study: one scene computed with many settings, read from TOML, and what is measured of the runs.
namespace flowrest::studies {

/// A setting laid over the scene: "mpm.cell", as TOML text "0.01", and where it was given.
struct Setting {
  std::string key;
  std::string value;
  scenes::Location where;
  /// "mpm.cell=0.01", as --set takes it.
  std::string text() const { return key + "=" + value; }
  bool same(const Setting& other) const { return key == other.key && value == other.value; }
};
using Settings = std::vector<Setting>;

enum class Solver { mpm, foam };
std::string to_string(Solver);

/// One thing that is varied: its alternatives, each of them one setting or several together.
struct Axis {
  std::string name;  ///< the key, or "choice" where several settings change together
  std::vector<Settings> alternatives;
};

/// A family of runs: every combination of its models and of the alternatives of its axes.
struct Sweep {
  std::string name;
  scenes::Location where;
  Solver solver = Solver::mpm;
  std::vector<scenes::Model> models;  ///< empty: the scene's own
  Settings settings;                  ///< of all of them
  std::vector<Axis> axes;
};

/// What runs are held against.
struct Reference {
  enum class Kind { none, run, exact, richardson, stated };
  Kind kind = Kind::none;
  scenes::Location where;
  // run and richardson
  Solver solver = Solver::mpm;
  std::optional<scenes::Model> model;
  Settings settings;
  Settings twin;                    ///< run: the coarser run whose difference is the uncertainty
  std::string refine;               ///< richardson: the key of the cell
  std::vector<double> refinements;  ///< its values
  // exact
  std::string solution;  ///< "leading-order", "second-order" or "steady"
  // stated, and the uncertainty of exact
  std::map<std::string, double> values, uncertainty;  ///< by quantity, in its unit
  std::string source;                                 ///< where stated values are from
};
std::string to_string(Reference::Kind);

/// A part of the study with a name, for those who cannot wait for the whole.
struct Cut {
  std::string name;
  std::string meaning;
  std::vector<std::string> sweeps;                       ///< empty: all
  std::map<std::string, std::vector<std::string>> only;  ///< the values of a key that are kept, as TOML text
  std::vector<double> refinements;                       ///< of a Richardson reference; empty: all
};

/// The limit that a quantity tends to as a setting grows.
struct LimitWish {
  std::string key;  ///< of the setting
  std::string quantity;
  double compare_to = 0.0;      ///< the value expected, in the quantity's unit; 0 where none is
  std::string compare_to_name;  ///< what it is: "second-order profile"
};

enum class Purpose {
  trade,  ///< error against cost
  map     ///< which settings end soundly, are refused or are stopped
};
std::string to_string(Purpose);

struct Study {
  std::string name;  ///< file name without extension
  std::filesystem::path path;
  std::string source;
  std::string title;
  Purpose purpose = Purpose::trade;
  std::string scene;  ///< name, or path from the study's folder
  Settings settings;  ///< of every run
  std::vector<std::string> quantities;
  Reference reference;
  std::vector<Sweep> sweeps;
  std::vector<Cut> cuts;
  std::optional<LimitWish> limit;
  double longest_run = 3600.0;  ///< s of wall time, after which a run is stopped and counts as too long
};

/// Reads a study. `study` is a path or the name of a file in scenes/studies.
/// @throws scenes::SceneError naming every fault found with file, line and column.
Study load_study(const std::string& study);
Study parse_study(const std::string& text, const std::filesystem::path& path);

/// Names of the studies there are.
std::vector<std::string> list_studies();

/// One run of a study.
struct Point {
  enum class Role { point, reference, reference_twin };
  Role role = Role::point;
  std::string id;     ///< a name for its folder: what is varied in words, and a mark of everything resolved
  std::string label;  ///< "MPM, mpm.cell = 0.01, mpm.precision = float"
  std::string sweep;
  Solver solver = Solver::mpm;
  Settings varied;                     ///< what tells it from the others of its sweep, model included
  std::optional<scenes::Scene> scene;  ///< resolved; none where it was refused
  std::string refused;                 ///< why
};
std::string to_string(Point::Role);

/// What a point that has a scene is expected to cost; less where it comes to rest before its end.
scenes::Cost expected_cost(const Point&);

/// Twelve letters and digits that stand for a text in the name of a folder: the same on every machine and in
/// every version.
std::string name_mark(const std::string& text);

/// Every run of the study, or of a cut of it (empty: the whole), references first. Runs that are the same are
/// made once.
/// @throws scenes::SceneError where there is no such cut, a reference is refused or, unless the study maps
/// refusals, a point is.
std::vector<Point> expand(const Study&, const std::string& cut = "");

}  // namespace flowrest::studies
