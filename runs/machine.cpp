#include "runs/machine.h"

#include <fmt/format.h>
#include <sys/statvfs.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <system_error>

#include "scenes/cost.h"

namespace flowrest::runs {

bool machine_is_at_fault(int error) {
  constexpr std::array of_the_machine = {ENOSPC, EDQUOT, EFBIG,  EIO,    ENOMEM, EAGAIN,   EMFILE,
                                         ENFILE, ENXIO,  ENODEV, ESTALE, ENOLCK, ETIMEDOUT};
  return std::find(of_the_machine.begin(), of_the_machine.end(), error) != of_the_machine.end();
}

void cannot_be_written(const std::filesystem::path& path, int error) {
  const std::string what = fmt::format("{}: cannot be written: {}", path.string(), std::strerror(error));
  if (machine_is_at_fault(error)) throw MachineError(what);
  throw RunError(what);
}

bool disk_is_full(const std::filesystem::path& path) {
  struct statvfs disk {};
  if (statvfs(path.c_str(), &disk) != 0) return false;
  constexpr unsigned long little = 65536;  // bytes: less than any field of a run
  return disk.f_bavail * disk.f_frsize < little || (disk.f_files > 0 && disk.f_favail == 0);
}

std::string to_string(Fault fault) {
  switch (fault) {
    case Fault::numerics:
      return "numerics";
    case Fault::machine:
      return "machine";
    case Fault::other:
      return "other";
  }
  throw std::logic_error("a fault without a name");
}

std::string verdict_of_failure(Fault fault) {
  return fault == Fault::numerics  ? "noisy: the numerics failed"
         : fault == Fault::machine ? "unjudged: the machine failed before the run's end"
                                   : "unjudged: the run failed";
}

Failure failure_at_hand(double memory) {
  try {
    throw;
  } catch (const NumericsError& error) {
    return {Fault::numerics, error.what()};
  } catch (const MachineError& error) {
    return {Fault::machine, error.what()};
  } catch (const std::bad_alloc&) {
    return {Fault::machine,
            fmt::format("out of memory: a run like this takes about {} (flowrest check says so beforehand); "
                        "larger cells or a machine with more memory help",
                        scenes::bytes_in_words(memory))};
  } catch (const std::system_error& error) {
    return {machine_is_at_fault(error.code().value()) ? Fault::machine : Fault::other, error.what()};
  } catch (const std::exception& error) {
    return {Fault::other, error.what()};
  }
}

void throw_again(const Failure& failure) {
  if (failure.fault == Fault::machine) throw MachineError(failure.reason);
  throw;
}

}  // namespace flowrest::runs
