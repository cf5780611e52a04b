#pragma once

#include <filesystem>
#include <string>

#include "runs/errors.h"

/// Whose fault a failure is: the numerics', the machine's, or what was asked for.
namespace flowrest::runs {

/// Whether an error number of the system (errno) speaks of the machine, as a full disk does, and not of a
/// path or a permission.
bool machine_is_at_fault(int error);

/// @throws MachineError or RunError, as the error number says, with the path and its reason in words.
[[noreturn]] void cannot_be_written(const std::filesystem::path&, int error);

/// Whether the disk that a path lies on has no room left that this user may fill.
bool disk_is_full(const std::filesystem::path&);

enum class Fault { numerics, machine, other };
/// As run.json has it in `failure`.
std::string to_string(Fault);
/// What the verdict on a run is that failed so: never "sound".
std::string verdict_of_failure(Fault);

/// Why a run failed.
struct Failure {
  Fault fault = Fault::other;
  std::string reason;
};

/// What the exception that is being handled says. Call it in a catch block. `memory` is what `flowrest check`
/// estimates for the run, bytes: it is told where memory ran out.
Failure failure_at_hand(double memory);

/// Throws the exception that is being handled once more, as a MachineError where the failure was the
/// machine's.
[[noreturn]] void throw_again(const Failure&);

}  // namespace flowrest::runs
