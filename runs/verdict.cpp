#include "runs/verdict.h"

namespace flowrest::runs {

namespace {

const std::string noisy = "noisy", coarse = "under-resolved", then = "; ";
/// As runs once called themselves whose cells were too few.
const std::string coarse_of_old = "noisy: under-resolved";

}  // namespace

std::string Doubt::word() const {
  if (!noisy) return under_resolved ? coarse : "";
  return under_resolved ? "noisy, " + coarse : "noisy";
}

Doubt doubt_of(const std::string& verdict) {
  Doubt doubt;
  doubt.noisy = verdict.starts_with(noisy) && !verdict.starts_with(coarse_of_old);
  doubt.under_resolved = verdict.starts_with(coarse) || verdict.starts_with(coarse_of_old) ||
                         verdict.find(then + coarse + ": ") != std::string::npos;
  if (!doubt.any()) return doubt;
  const auto colon = verdict.find(": ");
  doubt.why = colon == std::string::npos ? "no reason given" : verdict.substr(colon + 2);
  return doubt;
}

std::string with_resolution(const std::string& verdict, const std::string& unresolved) {
  if (unresolved.empty()) return verdict;
  const std::string said = coarse + ": " + unresolved;
  if (verdict == "sound") return said;
  return verdict.starts_with(noisy) ? verdict + then + said : said + then + verdict;
}

}  // namespace flowrest::runs
