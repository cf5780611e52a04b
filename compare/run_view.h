#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "runs/nose.h"

/// A run made ready for comparison: read, named, with its gauge as a series.
namespace flowrest::compare {

/// Whether a run's profiles are against a radius: those of slumps are, but in a plane.
bool radial(const runs::Run&, const ApparatusReport&);

/// A profile of depth as gauges read it; it looks into the profile.
runs::DepthView depth_of(const runs::Profile&, const runs::Run&);

/// Values of run.json by JSON pointer; empty where they are missing or of another type.
std::optional<double> number(const nlohmann::ordered_json& json, const char* pointer);
std::string word(const nlohmann::ordered_json& json, const char* pointer);
/// A number among the run's resolved settings: setting(view, "/material/density").
std::optional<double> setting(const RunView&, const std::string& key);

/// A history column as a series, without samples that are not numbers.
Series column(const runs::Run&, const std::string& name, double scale = 1.0);

/// A_thix / tau0: what the flocculation state gains in a second where nothing shears it (Yu et al. 2026, Eq.
/// 11), 1/s; 0 without thixotropy.
double flocculation_at_rest(const RunView&);

/// The run as the comparison sees it: named, with its gauge and its trouble.
RunView view_of(runs::Run, const ApparatusReport&);

/// Tells runs of the same solver and model apart by the settings in which they differ, else by their folders.
void make_labels_unique(std::vector<RunView>&);

/// Notes the physical settings in which the runs differ: a comparison of two scenes is not one of two
/// solvers.
void check_same_scene(Comparison&);

/// Notes the runs whose gauge is read at another depth than the first one's, and those that end with nothing
/// to read of it.
void note_gauges(Comparison&);

/// Notes the runs that the scene names and that are not among these, each with the command that makes it.
void note_missing(Comparison&);

/// Notes the runs whose walls are not those of the scene.
void note_walls(Comparison&);

/// Notes what the runs say of themselves to be implausible, once each.
void note_scenes(Comparison&);
/// What runs start from that do not start with their scene's body.
void note_starts(Comparison&);

/// The command that makes a run of the scene, with the settings of the first run of that solver, or else of
/// the first run: "flowrest foam roussel-slump --model bi-viscous". Nothing where the runs do not say of
/// which scene they are.
std::optional<std::string> command_for(const Comparison&, const std::string& solver,
                                       const std::string& model);

}  // namespace flowrest::compare
