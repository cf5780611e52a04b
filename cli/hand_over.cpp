#include "cli/hand_over.h"

#include <fmt/format.h>

#include <filesystem>

#include "mpm/output/hand_over.h"
#include "runs/run_directory.h"
#ifdef FLOWREST_HAS_FOAM
#include "foamCases/hand_over.h"
#endif
#ifdef FLOWREST_HAS_COMPARE
#include "compare/apparatus/arrested_slump.h"
#endif

namespace flowrest::cli {

namespace {

[[noreturn]] void refuse(const std::string& from, const std::string& why) {
  throw runs::RunError(
      fmt::format("--from {}: {}; allowed: the folder of a run by `flowrest mpm` or `flowrest foam`, "
                  "with @ and a time it has recorded, or exact/second-order",
                  from, why));
}

/// What left the run there: "mpm", "foam" or "exact".
std::string solver_of(const std::string& from, const std::filesystem::path& run) {
  std::string problem = "there is no run.json in it";
  const auto info = runs::read_info(run / "run.json", problem);
  if (!info) refuse(from, problem);
  if (info->value("method", "") == "elements")
    refuse(from, "a run by finite elements keeps no stresses to go on from");
  return info->value("solver", "");
}

}  // namespace

runs::MaterialState read_state(const std::string& from, [[maybe_unused]] const scenes::Scene& scene) {
  const runs::StateName name = runs::state_name(from);
  const bool is_run = std::filesystem::exists(name.run);
  const std::string solver = !is_run && name.run.starts_with("exact/") ? "exact" : solver_of(from, name.run);
  if (solver == "mpm") return mpm::read_state(from);
#ifdef FLOWREST_HAS_FOAM
  if (solver == "foam") return foam::read_state(from);
#endif
#ifdef FLOWREST_HAS_COMPARE
  if (solver == "exact") return compare::exact::arrested_state(from, scene);
#endif
  refuse(from, fmt::format("this flowrest reads no states of the solver '{}'", solver));
}

}  // namespace flowrest::cli
