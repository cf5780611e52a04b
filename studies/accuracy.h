#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.h"
#include "studies/results.h"

/// Settings for an accuracy that is asked for: what a study has found, kept with what made it, and how a
/// scene at hand makes use of it.
namespace flowrest::studies {

/// One run of a stored study.
struct KnownPoint {
  scenes::Model model = scenes::Model::elasto_viscoplastic;
  std::vector<std::pair<std::string, std::string>>
      settings;        ///< key and TOML text, but for the model and the cell
  double cell = 0.0;   ///< m
  double error = 0.0;  ///< relative
  double cpu = 0.0;    ///< s
  double work = 0.0;   ///< s, what it was expected to cost: the measure by which its cost is carried over
};

/// What a study knows of scenes of one apparatus.
struct Knowledge {
  std::string study, cut, scene, quantity, apparatus;
  scenes::Dimension dimension = scenes::Dimension::axisymmetric;
  double length = 0.0;       ///< m, of the scene's body: cells are carried over in proportion to it
  double uncertainty = 0.0;  ///< of the reference, relative
  std::string reference;     ///< in words
  std::string made_by;       ///< flowrest's commit, the processor and the time
  std::vector<KnownPoint> points;
};

/// The sound MPM runs of a study that measured its first quantity; what `flowrest study --keep` stores.
nlohmann::ordered_json knowledge_json(const Results&);

/// Every scenes/studies/*.known.json that can be read. @throws runs::RunError where one is malformed.
std::vector<Knowledge> stored_knowledge();
Knowledge parse_knowledge(const nlohmann::ordered_json&);

/// What is run for an accuracy, and why.
struct Choice {
  std::vector<std::string> set;        ///< for --set
  std::vector<std::string> twin_set;   ///< of the coarser twin
  std::string quantity;                ///< by which the twin is held against the run
  double cell = 0.0, twin_cell = 0.0;  ///< m
  double expected_error = 0.0;         ///< relative, with the reference's uncertainty
  double expected_cpu = 0.0;           ///< s, run and twin
  std::string why;
};

/// The cheapest settings known to reach `accuracy` (relative) for this kind of scene and its model.
/// @throws scenes::SceneError saying what is known and what is not, where none is known to.
Choice choose(const std::vector<Knowledge>&, const scenes::Scene&, double accuracy);

/// "2%", "2 %" or "0.02" as 0.02. @throws scenes::SceneError unless above 0 and below 1.
double accuracy_from(const std::string&);

/// The error of a run by its twin on cells coarser by a factor r, as if of first order: |run - twin| / (r -
/// 1), relative to the run. First order is the cautious assumption: a higher one makes the error smaller.
double error_by_twin(double value, double twin_value, double coarser);

}  // namespace flowrest::studies
