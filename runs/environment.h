#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace flowrest::runs {

/// The environment that helper programs (gmsh, gnuplot, Snakemake, OpenFOAM's ...) are started in. It is one
/// of ours: what a user has set for a program, by variables or by files in the home, does not reach it, and
/// numbers have decimal points.
class Environment {
 public:
  /// With a home that nothing is kept in, and that is the place for temporary files too: one for all programs
  /// of this process, gone when it ends.
  static Environment of_helper();
  /// With this folder as the home: for what outlives this process or runs on other machines. It is made where
  /// it is missing.
  static Environment with_home(const std::filesystem::path& home);

  Environment& set(const std::string& name, const std::string& value);
  /// Hands on what this process was told in variables whose names begin so.
  Environment& keep(const std::string& beginning);

  const std::map<std::string, std::string>& entries() const { return entries_; }

 private:
  struct Home {
    std::filesystem::path path;
  };
  explicit Environment(const Home&);
  std::map<std::string, std::string> entries_;
};

/// An environment as execve takes it: "NAME=VALUE" each.
std::vector<std::string> texts_of(const std::map<std::string, std::string>& entries);
/// Texts as execve takes them, null at the end; they point into `texts`.
std::vector<char*> pointers_to(std::vector<std::string>& texts);

/// All that this process was told: for its own program as a child.
std::map<std::string, std::string> own_environment();

}  // namespace flowrest::runs
