#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scenes/scene.h"

/// What the papers and their experiments say of scenes: scenes/published.csv and scenes/papers.csv.
namespace flowrest::studies::validation {

/// How far a published number is evidence.
enum class Mark {
  independent,  ///< nothing in the scene was made from it
  calibrated,   ///< a parameter of the scene was fitted to it
  circular,     ///< a parameter of the scene was computed back from it
  exact         ///< a closed form
};
std::string to_string(Mark);

/// A published number of a scene.
struct Published {
  std::string scene = {}, quantity = {};
  std::optional<double> measured = {},
                        paper = {};  ///< in the quantity's unit: experiment, the paper's own simulation
  double allowed = 0.0;              ///< difference that still counts as agreement
  Mark mark = Mark::independent;
  std::string source = {};                  ///< "Yu Table 2"
  std::optional<scenes::Model> model = {};  ///< whose number it is; empty: of whatever law
  /// What runs are held against: the measurement where there is one.
  std::optional<double> target() const { return measured ? measured : paper; }
};

/// A figure or table of a paper and the scene that reproduces it.
struct PaperItem {
  std::string paper = {}, item = {}, scene = {}, what = {};
};

/// @throws runs::RunError with the line at fault.
std::vector<Published> read_published();
std::vector<PaperItem> read_paper_items();

/// What is exactly known of a scene without being published, law by law: a regularised fluid has its own.
std::vector<Published> exact_numbers(const std::string& name, const scenes::Scene&);

}  // namespace flowrest::studies::validation
