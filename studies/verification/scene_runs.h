#pragma once

#include <string>
#include <vector>

#include "runs/run_directory.h"
#include "studies/verification/verification.h"

namespace flowrest::studies::verification {

/// Runs a scene with one of flowrest's solvers in a process of its own (the HDF5 library is not made for
/// threads) and reads what it leaves. `solver` is "mpm" or "foam".
/// @throws runs::NumericsError with the run's last words where it does not come to its end.
runs::Run run_scene(const std::string& scene, const std::vector<std::string>& set, const std::string& solver,
                    const Workplace&);

/// Differentiates a scene's run in the same way, with its checks: gradient.json of one quantity.
nlohmann::json run_gradient(const std::string& scene, const std::vector<std::string>& set,
                            const std::string& of, const std::string& by, const std::string& mode,
                            const Workplace&);

/// "key=value" with every digit of the value.
std::string setting(const std::string& key, double value);

}  // namespace flowrest::studies::verification
