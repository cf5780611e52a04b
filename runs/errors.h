#pragma once

#include <stdexcept>

/// What can go wrong with a run, each kind with an exit code of its own.
namespace flowrest::runs {

/// A run directory that cannot be written or read (exit 2). what() names the file, what is wrong and what is
/// expected.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The numerics failed (exit 3): the run directory stays, with the reason.
class NumericsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A program that is needed is missing (exit 4). what() says which and how to get it.
class MissingProgram : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The machine failed (exit 5): a full disk, no memory, an unreadable device. What was written stays.
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Somebody asked this process to stop before a run had begun (exit 130). what() says so.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace flowrest::runs
