#pragma once

#include <string>

/// What a run says of itself in one line of run.json, and how it is read: sound; noisy, where part of its
/// motion may be the numerics'; under-resolved, where its cells are too few for what is sheared.
namespace flowrest::runs {

/// A verdict as whoever reads a run must take it.
struct Doubt {
  bool noisy = false;
  bool under_resolved = false;
  std::string why;  ///< empty where there is no doubt

  bool any() const { return noisy || under_resolved; }
  /// For legends and badges: "noisy", "under-resolved", "noisy, under-resolved"; empty where there is none.
  std::string word() const;
};

/// Of a verdict as run.json has it; one that nobody judged is not in doubt.
Doubt doubt_of(const std::string& verdict);

/// A verdict that also says what the cells do not resolve ("", where they do). The worse stands first: noise
/// can make a number right by chance, too few cells make it wrong in a known direction.
std::string with_resolution(const std::string& verdict, const std::string& unresolved);

}  // namespace flowrest::runs
