#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compare/comparison.h"
#include "compare/report/page.h"

/// What a run's inputs make of its uncertainty, where `flowrest gradient --sigma` has said so beside it: u_input of
/// ASME V&V 20-2009, section 4.
namespace flowrest::compare {

/// Of one quantity of a run.
struct InputPart {
  std::string quantity, unit;
  double value = 0.0, standard = 0.0;  ///< in that unit: the quantity, and one standard uncertainty
  struct Share {
    std::string key;
    double share;  ///< of the variance
  };
  std::vector<Share> shares;  ///< the largest first
};

/// The gradients that gradient.json in a run's directory holds, one a quantity; of those that failed their check
/// nothing.
std::vector<nlohmann::json> sound_gradients(const runs::Run&);

/// Their inputs' parts, where they have any.
std::vector<InputPart> input_parts(const runs::Run&);

/// A chapter of them; nothing where no run has any.
std::optional<report::Chapter> input_chapter(const Comparison&);

}  // namespace flowrest::compare
