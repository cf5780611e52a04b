#include "foamCases/apparatus/duct.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "foamCases/duct_sampler.h"
#include "foamCases/step_rules.h"

namespace flowrest::foam {

namespace {

constexpr double most_cells = 1e5;
constexpr double for_ever = 1e9;  // s

/// One column of cells from plate to plate.
class DuctCase : public ApparatusCase {
 public:
  DuctCase(const scenes::Duct& duct, const scenes::Scene& scene) : ApparatusCase(scene), duct_(duct) {}

  /// foam.cell fitted to the height.
  std::size_t cells() const override {
    const double cells = duct_.height / scene().foam.cell;
    if (!(cells >= 0.5 && cells <= most_cells))
      refuse(fmt::format("foam.cell = {:g} m lays {:.3g} cells between the plates; allowed: 1 to {:g}",
                         scene().foam.cell, cells, most_cells));
    return static_cast<std::size_t>(std::lround(cells));
  }
  std::size_t slices() const override { return 1; }
  double estimated_cells() const override { return std::round(duct_.height / scene().foam.cell); }
  bool slows() const override { return false; }

  std::string mesh_parameters() const override {
    return fmt::format(
        "// Mesh, m: a column of cells from plate to plate.\n"
        "ductHeight          {};\n"
        "ductCells           {};\n"
        "cellWidth           {};\n",
        duct_.height, cells(), duct_.height / static_cast<double>(cells()));
  }
  std::string force_parameters() const override {
    return fmt::format(
        "\n// Forces (N/m3, from a time on) and walls.\nplateWall           {};\nbodyForces\n{{\n{}}}\n",
        scene().base.law == scenes::Wall::slip ? "slip" : "noSlip", body_forces());
  }
  std::vector<Utility> utilities() const override { return {}; }
  std::unique_ptr<Sampler> sampler(CaseFields fields, runs::RunWriter& writer, bool plug_in) const override {
    return std::make_unique<DuctSampler>(scene(), cells(), std::move(fields), writer, plug_in);
  }

 private:
  /// A source holds for the steps that end within its times; a step that ends on a change still has the old
  /// force.
  std::string body_forces() const {
    const auto& forces = scene().forces.body_force;
    const double late = 1e-3 * largest_step(*this);
    std::string text;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const auto& [time, force] = forces[i];
      const double end = i + 1 < forces.size() ? forces[i + 1].first : for_ever;
      text += fmt::format(
          "    from{0}\n    {{\n        type            vectorSemiImplicitSource;\n        timeStart       "
          "{1};\n"
          "        duration        {2};\n        selectionMode   all;\n        volumeMode      specific;\n"
          "        injectionRateSuSp {{ U (({3} 0 0) 0); }}\n    }}\n",
          i, time + late, std::max(end - time - 0.5 * late, 0.0), force);
    }
    return text;
  }

  const scenes::Duct& duct_;
};

}  // namespace

std::unique_ptr<ApparatusCase> case_of(const scenes::Duct& duct, const scenes::Scene& scene) {
  return std::make_unique<DuctCase>(duct, scene);
}

}  // namespace flowrest::foam
