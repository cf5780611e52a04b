#pragma once

#include <string>

namespace flowrest::cli {

/// What `flowrest --version` says: version, commit, build, which parts are there, and which OpenFOAM.
std::string version_text();

}  // namespace flowrest::cli
