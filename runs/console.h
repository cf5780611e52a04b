#pragma once

#include <cstdio>
#include <string_view>

/// What is said to the user while a run goes on.
namespace flowrest::runs {

/// Prints. What cannot be printed, because the terminal was closed, nobody reads the pipe or the disk of a
/// log is full, is lost, and nothing else is.
void say(std::FILE*, std::string_view) noexcept;

/// Opens /dev/null in place of those of the standard streams that the caller has closed: a data file that
/// came by one of their numbers would be written into with every word to the user. Writing past a limit on
/// the size of files becomes an error instead of a signal.
void settle_standard_streams();

}  // namespace flowrest::runs
