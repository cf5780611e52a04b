// flowrest: when does fresh concrete stop, where, and which simulation can be trusted to say so?
// Each room adds its own subcommands; this file only assembles them and turns what went wrong into exit
// codes.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "cli/run_command.h"
#include "mpm/commands.h"
#include "runs/run_directory.h"
#include "scenes/commands.h"
#include "scenes/scene.h"
#ifdef FLOWREST_HAS_FOAM
#include "foamCases/commands.h"
#endif
#ifdef FLOWREST_HAS_COMPARE
#include "compare/commands.h"
#include "studies/commands.h"
#endif

namespace {

enum Exit { bad_input = 2, numerics_failed = 3, program_missing = 4 };

int fail(int code, const char* what) {
  std::fprintf(stderr, "flowrest: %s\n", what);
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace flowrest;
  CLI::App app{
      "flowrest: when does fresh concrete stop, where, and which simulation can be trusted to say so?"};
  app.require_subcommand(1);
  app.set_version_flag("--version", FLOWREST_VERSION);
  scenes::add_commands(app);
  mpm::add_commands(app);
#ifdef FLOWREST_HAS_FOAM
  foam::add_commands(app);
#endif
#ifdef FLOWREST_HAS_COMPARE
  compare::add_commands(app);
  studies::add_commands(app);
#endif
  cli::add_run_command(app);
  try {
    app.parse(argc, argv);
    return 0;
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();
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
  } catch (const std::exception& error) {
    return fail(1, error.what());
  }
}
