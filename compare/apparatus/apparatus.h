#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/exact/creep.h"
#include "compare/exact/exact_run.h"
#include "compare/measures/gauges.h"
#include "compare/report/page.h"
#include "compare/run_table.h"
#include "scenes/scene.h"

/// What is peculiar to each apparatus in a report: its gauges and readings, its words and questions, and what
/// is exactly known of it. Whatever follows from what it is judged by is asked of that instead.
namespace flowrest::compare {

class ApparatusReport {
 public:
  explicit ApparatusReport(const scenes::Apparatus&);
  virtual ~ApparatusReport() = default;
  ApparatusReport(const ApparatusReport&) = delete;
  ApparatusReport& operator=(const ApparatusReport&) = delete;

  const std::string& name() const { return name_; }
  scenes::MainGauge judged_by() const { return judged_by_; }
  /// Whether a run ends at rest unless its scene says otherwise.
  bool rests() const { return rests_; }
  /// Whether material spreads from a middle, flat on it.
  bool spreads() const { return judged_by_ == scenes::MainGauge::spread; }
  /// Whether the gauge is a length that grows until the material is at rest.
  bool grows() const { return spreads() || judged_by_ == scenes::MainGauge::front; }
  /// Whether profiles hold depths; else velocities.
  bool has_depth() const { return judged_by_ != scenes::MainGauge::velocity; }
  /// The depth at which the gauge finds its edge, m.
  double edge_depth(const scenes::Gauges& gauges) const { return gauges.edge_depth(judged_by_); }
  /// Whether it is news that a run still moves.
  virtual bool motion_is_news() const { return true; }
  /// Whether a section seen from above shows more than an upright one.
  virtual bool seen_from_above() const { return false; }

  /// m from where the front is counted to the wall before which it may stop; nothing where there is none.
  virtual std::optional<double> channel_length(const scenes::Scene&) const { return std::nullopt; }

  /// The gauge by which runs are told apart.
  virtual const Gauge& gauge() const = 0;
  /// What else is worth a figure against time; a run need not have it.
  virtual const std::vector<Gauge>& further_gauges() const = 0;
  /// The readings that say what a run came to.
  virtual const std::vector<Reading>& readings() const = 0;

  /// m/s, what the regularisation alone would leave of this run; nothing where it is not known.
  virtual std::optional<double> predicted_creep(const RunView&, const exact::RegularisedFluid&) const {
    return std::nullopt;
  }
  /// How fast the exact material would still approach rest, of runs that move and do not creep; fluids whose
  /// speed beyond that is within the factor of their creep are said to approach rest.
  virtual void measure_approach(Comparison&) const {}

  /// Its part of the headline where nothing has come to rest; `arrested`: a run that stopped, if there is one.
  virtual std::string opening(const Comparison&, const RunView* /*arrested*/) const { return ""; }
  /// What its readings say of a run.
  virtual std::string readings_sentence(const Comparison&, const RunView&) const { return ""; }
  /// Tells what was found, and which comparison is fair.
  virtual void describe(Comparison&) const;
  /// Chapters of its own, after those on the gauge.
  virtual std::vector<report::Chapter> chapters(const Comparison&) const { return {}; }
  virtual std::string stop_question() const { return "When does each stop, and where?"; }

  virtual std::string measures_caption(const Comparison&) const;
  virtual std::vector<RunColumn> measure_columns(const Comparison&) const;
  virtual std::string residual_caption(const Comparison&) const;
  /// The measures that it has, under the names of comparison.json.
  virtual nlohmann::ordered_json measures_json(const Measures&) const;

  /// @throws runs::RunError where the scene has no exact solution, saying why.
  virtual std::vector<exact::ExactRun> write_exact_runs(const scenes::Scene&,
                                                        const std::filesystem::path& directory,
                                                        std::optional<double> flocculation,
                                                        runs::Replace) const;
  /// @throws runs::RunError where no thin film is known of the scene, saying why.
  virtual void check_film(const scenes::Scene&) const;
  virtual exact::ExactRun write_film_run(const scenes::Scene&, const std::filesystem::path& directory,
                                         bool plug_pulls, runs::Replace) const;

 private:
  std::string name_;
  scenes::MainGauge judged_by_;
  bool rests_;
};

/// The one place of this room where apparatus are told apart.
const ApparatusReport& report_of(const scenes::Apparatus&);

}  // namespace flowrest::compare
