#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "compare/report/page.h"
#include "studies/validation/validation.h"
#include "studies/verification/verification.h"

/// The accuracy ledger: what every quantity was known to be, commit by commit (docs/measured/ledger.csv). Rows
/// are only ever added.
namespace flowrest::studies::ledger {

/// A row: a quantity of one solver with its settings, measured once.
struct Entry {
  std::string date;      ///< "2026-12-01", UTC
  std::string commit;    ///< that the sources lie on: the row's own is made after it
  std::string sources;   ///< hash of the sources as they were built
  std::string quantity;  ///< "Poiseuille flow, Bingham: relative L2 of the velocity"
  std::string solver;    ///< "MPM quadratic-apic, elasto-viscoplastic, double"
  std::string settings;  ///< what else it hangs on: "cell 0.0125"
  double value = 0.0;
  std::optional<double> reference;    ///< what is known, published or measured
  double error = 0.0;                 ///< in the same unit; of a norm the norm itself
  std::optional<double> uncertainty;  ///< plus or minus, likewise
  double cpu = 0.0;                   ///< s

  /// Rows with the same key tell of the same thing.
  std::string key() const { return quantity + " | " + solver + " | " + settings; }
};

std::vector<Entry> entries_of(const std::vector<verification::Finding>&);
std::vector<Entry> entries_of(const validation::Validation&);

/// @throws runs::RunError with file:line where it is malformed; no file has no rows.
std::vector<Entry> read(const std::filesystem::path&);

/// Adds rows at the end; what stands there is not touched. A row of the same key and sources as one that is
/// there is left out. @return how many were added. @throws runs::RunError, runs::MachineError
std::size_t append(const std::filesystem::path&, const std::vector<Entry>&);

/// What moved between the last row of a key and one that is new.
struct Change {
  Entry before, now;
  /// By how much the error grew, beyond which it is worse: what both are uncertain by, and a hundredth of the
  /// error where they do not say.
  double growth = 0.0, bound = 0.0;
  bool worse() const { return growth > bound; }
};

/// Every entry of `now` whose key stands in the ledger, against its last row there.
std::vector<Change> changes(const std::vector<Entry>& ledger, const std::vector<Entry>& now);

/// What a command is asked to do with a ledger.
struct Asked {
  std::string file;  ///< empty: nothing
  bool compare_only = false;
};
/// The options --ledger FILE and --compare-only.
std::shared_ptr<Asked> add_options(CLI::App&);

/// Prints what got worse since it was last entered; then adds the rows, unless asked only to compare.
/// @return whether nothing got worse; asked only to compare, it only tells
bool enter(const Asked&, const std::vector<Entry>& now);

/// Each quantity over commits, with bias and scatter of each quantity over all its settings.
report::Page page_of(const std::vector<Entry>&);

}  // namespace flowrest::studies::ledger
