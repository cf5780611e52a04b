#pragma once

#include <optional>
#include <string>

#include "compare/comparison.h"

/// Sentences that findings of several apparatus are made of.
namespace flowrest::compare {

/// Adds a finding; an empty one is none.
void tell(Comparison&, Finding::Topic, std::string text);

std::string capitalised(std::string text);

/// What doubts there are about a run, in brackets, at a sentence's end.
std::string doubt_in_brackets(const RunView&);
/// A reading of a run in words; nothing where it has none.
std::optional<std::string> reading_of(const Comparison&, const RunView&, const std::string& quantity);

/// When an event takes place in every run: "light is seen through the funnel after 1.4 s (MPM ...)".
std::string event_clause(const Comparison&, const std::string& quantity, const std::string& happens,
                         const std::string& never);
/// How far apart an event is between two laws in one solver, and between two solvers of one law.
std::string events_apart(const Comparison&, const std::string& quantity, const std::string& event);
/// When a front meets the end wall and, where that is told, how high it stands there.
std::string arrival_sentence(const Comparison&, const RunView&, bool with_height);

/// Law against solver: the same solver with another law, and the same law in another solver.
std::string split_sentence(const Comparison&);
/// The whole difference between the fluid in OpenFOAM and the material in MPM, split.
std::string square_sentence(const Comparison&);
/// What still moves, held against what the regularisation alone predicts.
std::string cause_sentence(const Comparison&);
/// How lambda goes: down while it flows, up again at rest.
std::string flocculation_sentence(const Comparison&);

/// What grows until it comes to rest: a slump, or what runs along a box or a tank.
void describe_growth(Comparison&);

/// Which comparison is fair where nothing exact is known.
extern const char* const fair_runs;

}  // namespace flowrest::compare
