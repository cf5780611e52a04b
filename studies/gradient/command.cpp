#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "runs/console.h"
#include "runs/process.h"
#include "runs/run_folder.h"
#include "studies/gradient/gradient.h"

namespace flowrest::studies::gradient {

namespace {

void print(const Result& result) {
  for (const Gradient& g : result.gradients) {
    fmt::print("{} = {:.6g} {}\n", g.quantity.name, g.value, g.quantity.unit);
    if (g.asked != g.quantity.name && !g.reaches && !g.quantity.place)
      fmt::print(
          "  in place of {}, which jumps as particles cross its bins{}\n", g.asked,
          g.column ? fmt::format("; {} reads {:.6g} {}", g.quantity.column, *g.column, g.quantity.unit) : "");
    for (const Derivative& d : g.by) {
      fmt::print("  by {:<34} {:>13.6g}   elasticity {:>9.5f}", d.key.path, d.value, d.elasticity);
      if (d.check)
        fmt::print(
            "   differences {:.6g}, Taylor slope {}", d.check->central_difference,
            d.check->linear ? std::string("none: linear") : fmt::format("{:.2f}", d.check->taylor_slope));
      fmt::print("\n");
    }
    if (g.has_sigma())
      fmt::print("  input uncertainty ± {:.4g} {}\n", g.input_uncertainty(), g.quantity.unit);
    if (!g.doubt.empty()) fmt::print("  {}\n", g.doubt);
  }
  fmt::print("{} CPU s for the run, {:.3g} for its derivatives\n{}\n",
             fmt::format("{:.3g}", result.cost.forward_cpu), result.cost.gradient_cpu,
             (result.directory / "gradient.html").string());
}

}  // namespace

void add_command(CLI::App& app) {
  struct Arguments {
    Options options;
    std::string output;
    bool json = false;
  };
  auto arguments = std::make_shared<Arguments>();
  Options& options = arguments->options;
  CLI::App* command =
      app.add_subcommand("gradient", "Differentiate a run: how its results change with the scene's keys");
  command->add_option("scene", options.scene, "A scene's name, or the path of its file")->required();
  command
      ->add_option("--of", options.of, "Quantities, parted by commas: columns of history.csv, or their twins")
      ->delimiter(',');
  command->add_option("--by", options.by, "Keys, parted by commas: material.yield_stress, ...")
      ->delimiter(',')
      ->required();
  command
      ->add_option("--sigma", options.sigma,
                   "KEY=5%,...: standard uncertainties, of which the result has its share")
      ->delimiter(',');
  command->add_option("--model", options.model, laws::all_names() + ", in place of material.model");
  command->add_option("--set", options.set, "KEY=VALUE: override a key by its dotted path")
      ->allow_extra_args(false);
  command->add_option("-o,--output", arguments->output, "The run directory (out/SCENE/gradient-MODEL)");
  command
      ->add_option(
          "--mode", options.mode,
          "forward: by up to eight keys at once; reverse: by any number, for one quantity at a time; auto: "
          "the cheaper one")
      ->check(CLI::IsMember({"auto", "forward", "reverse"}))
      ->capture_default_str();
  command
      ->add_option("--memory", options.memory,
                   "For states that reverse keeps: 500M, 4G; others are made again (4G)")
      ->transform(CLI::AsSizeValue(true));
  command->add_flag("--check", options.check, "Taylor remainders and central differences for every key");
  command->add_flag("--force", options.force, runs::force_help);
  command->add_flag("--json", arguments->json, "End with a machine-readable line");
  command->add_flag("--quiet", options.quiet, "Print no progress");
  command->callback([arguments] {
    arguments->options.output = arguments->output;
    const runs::InterruptGuard guard;
    const Result result = compute(arguments->options);
    write(result);
    print(result);
    if (arguments->json) runs::say(stdout, json_of(result).dump() + "\n");
    constexpr int numerics_failed = 3;
    if (!result.sound) throw CLI::RuntimeError(numerics_failed);
  });
}

}  // namespace flowrest::studies::gradient
