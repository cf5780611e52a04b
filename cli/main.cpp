// flowrest: when does fresh concrete stop, where, and which simulation can be trusted to say so?
// Each room adds its own subcommands; this file only assembles them and turns what went wrong into exit
// codes.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <system_error>

#include "cli/hand_over.h"
#include "cli/run_command.h"
#include "cli/version.h"
#include "mpm/commands.h"
#include "mpm/cost.h"
#include "runs/console.h"
#include "runs/machine.h"
#include "scenes/commands.h"
#include "scenes/scene.h"
#ifdef FLOWREST_HAS_FOAM
#include "foamCases/commands.h"
#include "foamCases/cost.h"
#endif
#ifdef FLOWREST_HAS_COMPARE
#include "compare/commands.h"
#include "studies/commands.h"
#endif

namespace {

enum Exit { bad_input = 2, numerics_failed = 3, program_missing = 4, machine_failed = 5, interrupted = 130 };

constexpr const char* exit_codes =
    "Exit codes: 0 done; 2 bad input or a folder that may not be written into, nothing is changed; 3 the "
    "numerics "
    "failed; 4 a program is missing; 5 the machine failed (disk, memory), what was written stays; 130 "
    "interrupted.";

int fail(int code, const std::string& what) {
  flowrest::runs::say(stderr, "flowrest: " + what + "\n");
  return code;
}

/// What was said last may still be on its way.
int flushed(int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  if (code != 0 || !flowrest::runs::machine_is_at_fault(errno)) return code;
  return fail(machine_failed, std::string("standard output: cannot be written: ") + std::strerror(errno));
}

}  // namespace

int main(int argc, char** argv) {
  using namespace flowrest;
  runs::settle_standard_streams();
  CLI::App app{
      "flowrest: when does fresh concrete stop, where, and which simulation can be trusted to say so?"};
  app.require_subcommand(1);
  app.footer(exit_codes);
  app.set_version_flag("--version", cli::version_text, "Say version, commit, build, parts and OpenFOAM");
  scenes::Estimates estimates;
  estimates.mpm = mpm::cost;
#ifdef FLOWREST_HAS_FOAM
  estimates.foam = foam::estimate;
#endif
  scenes::add_commands(app, estimates);
  mpm::add_commands(app, cli::read_state);
#ifdef FLOWREST_HAS_FOAM
  foam::add_commands(app, cli::read_state);
#endif
#ifdef FLOWREST_HAS_COMPARE
  compare::add_commands(app);
  studies::add_commands(app);
#endif
  cli::add_run_command(app);
  try {
    app.parse(argc, argv);
    return flushed(0);
  } catch (const CLI::RuntimeError& error) {
    return flushed(error.get_exit_code());
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : bad_input;
  } catch (const scenes::SceneError& error) {
    return fail(bad_input, error.what());
  } catch (const runs::NumericsError& error) {
    return fail(numerics_failed, error.what());
  } catch (const runs::MissingProgram& error) {
    return fail(program_missing, error.what());
  } catch (const runs::RunError& error) {
    return fail(bad_input, error.what());
  } catch (const runs::MachineError& error) {
    return fail(machine_failed, error.what());
  } catch (const runs::Interrupted& error) {
    return fail(interrupted, error.what());
  } catch (const std::bad_alloc&) {
    return fail(machine_failed, "out of memory; `flowrest check` estimates what a scene takes");
  } catch (const std::system_error& error) {
    return fail(runs::machine_is_at_fault(error.code().value()) ? machine_failed : 1, error.what());
  } catch (const std::exception& error) {
    return fail(1, error.what());
  }
}
