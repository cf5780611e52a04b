#include "elements/commands.h"

#include <fmt/format.h>

#include "elements/run.h"
#include "runs/console.h"
#include "runs/process.h"

namespace flowrest::elements {

std::shared_ptr<Options> add_options(CLI::App& exact, const std::vector<std::string>& others) {
  auto options = std::make_shared<Options>();
  CLI::Option* chosen =
      exact.add_flag("--elements", options->chosen,
                     "Instead, compute a slump by finite elements, two-dimensional and with inertia, "
                     "with the uncertainty of its spread at each time");
  for (const auto& name : others) chosen->excludes(exact.get_option(name));
  exact
      .add_option("--columns", options->columns,
                  "Columns of elements from the axis to the toe; rows and steps go with them")
      ->check(CLI::Range(12, 400))
      ->capture_default_str()
      ->needs(chosen);
  exact.add_flag("--quiet", options->quiet, "Print no progress")->needs(chosen);
  return options;
}

void run_command(const scenes::Scene& scene, const Options& asked, const std::string& output, bool force,
                 bool json) {
  const runs::InterruptGuard guard;
  RunOptions options;
  options.directory = output.empty() ? std::filesystem::path("out") / scene.name / "exact" / "elements"
                                     : std::filesystem::path(output);
  options.replace = force ? runs::Replace::anything : runs::Replace::unfinished;
  options.columns = asked.columns;
  options.quiet = asked.quiet;
  options.interrupted = [] { return runs::InterruptGuard::count() > 0; };
  const RunResult result = run(scene, options);
  runs::say(stdout, fmt::format("{}\n  {}\n", result.summary, options.directory.string()));
  if (json)
    runs::say(stdout, nlohmann::ordered_json{{"runs", {options.directory.string()}},
                                             {"status", runs::to_string(result.status)}}
                              .dump() +
                          "\n");
  if (result.status == runs::Status::interrupted) throw CLI::RuntimeError(130);
}

}  // namespace flowrest::elements
