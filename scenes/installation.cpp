#include "scenes/installation.h"

namespace flowrest::scenes {

namespace fs = std::filesystem;

namespace {

fs::path prefix() { return program_file().parent_path().parent_path(); }

}  // namespace

fs::path program_file() { return fs::read_symlink("/proc/self/exe"); }

fs::path shared_folder(const std::string& name) {
  // A build tree links to the sources: whoever reads a path wants the file that he would edit.
  return fs::weakly_canonical(prefix() / "share" / "flowrest" / name);
}

fs::path openfoam_library(const std::string& name) {
  return prefix() / "lib" / "flowrest" / "openfoam" / name;
}

}  // namespace flowrest::scenes
