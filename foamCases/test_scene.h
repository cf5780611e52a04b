#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "foamCases/openfoam.h"
#include "runs/errors.h"
#include "runs/temporary_folder.h"
#include "scenes/scene.h"

/// What this room's tests share.
namespace flowrest::foam::testing {

inline scenes::Scene roussel_slump(const std::string& model, const std::vector<std::string>& set = {}) {
  return scenes::load_scene("roussel-slump", {set, scenes::model_from_name(model)});
}

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Why no case can be run; empty where they can.
inline std::string what_openfoam_lacks() {
  try {
    openfoam_program("interFoam");
  } catch (const runs::MissingProgram& missing) {
    return missing.what();
  }
  return "";
}

using runs::TemporaryFolder;

}  // namespace flowrest::foam::testing
