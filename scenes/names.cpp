#include "scenes/names.h"

#include "scenes/text.h"

namespace flowrest::scenes {

const NameTable<Dimension>& names_of(Dimension) {
  static const NameTable<Dimension> table = {{Dimension::axisymmetric, "axisymmetric"},
                                             {Dimension::plane, "plane"},
                                             {Dimension::half, "half"},
                                             {Dimension::quarter, "quarter"},
                                             {Dimension::full, "full"}};
  return table;
}

const NameTable<PrintDirection>& names_of(PrintDirection) {
  static const NameTable<PrintDirection> table = {{PrintDirection::same, "same"},
                                                  {PrintDirection::alternating, "alternating"}};
  return table;
}

const NameTable<Model>& names_of(Model) {
  static const NameTable<Model> table = [] {
    NameTable<Model> names;
    for (const Model law : laws::every_law) names.emplace_back(law, laws::name_of(law));
    return names;
  }();
  return table;
}

const NameTable<Scheme>& names_of(Scheme) {
  static const NameTable<Scheme> table = {{Scheme::quadratic_apic, "quadratic-apic"},
                                          {Scheme::linear_flip, "linear-flip"},
                                          {Scheme::paper, "paper"}};
  return table;
}

const NameTable<Precision>& names_of(Precision) {
  static const NameTable<Precision> table = {{Precision::double_precision, "double"},
                                             {Precision::single_precision, "float"}};
  return table;
}

const NameTable<Seeding>& names_of(Seeding) {
  static const NameTable<Seeding> table = {
      {Seeding::lattice, "lattice"}, {Seeding::jittered, "jittered"}, {Seeding::gmsh, "gmsh"}};
  return table;
}

const NameTable<FluidUpdate>& names_of(FluidUpdate) {
  static const NameTable<FluidUpdate> table = {{FluidUpdate::implicit_update, "implicit"},
                                               {FluidUpdate::explicit_update, "explicit"}};
  return table;
}

const NameTable<BBar>& names_of(BBar) {
  static const NameTable<BBar> table = {{BBar::smooth, "smooth"}, {BBar::cell_average, "cell-average"}};
  return table;
}

const NameTable<Wall>& names_of(Wall) {
  static const NameTable<Wall> table = {{Wall::no_slip, "no-slip"}, {Wall::slip, "slip"}};
  return table;
}

const NameTable<FoamLaws>& names_of(FoamLaws) {
  static const NameTable<FoamLaws> table = {
      {FoamLaws::best, "best"}, {FoamLaws::plug_in, "plug-in"}, {FoamLaws::built_in, "built-in"}};
  return table;
}

const NameTable<FoamMixing>& names_of(FoamMixing) {
  static const NameTable<FoamMixing> table = {{FoamMixing::arithmetic, "arithmetic"},
                                              {FoamMixing::harmonic, "harmonic"},
                                              {FoamMixing::mass_weighted, "mass-weighted"},
                                              {FoamMixing::saturating, "saturating"}};
  return table;
}

const NameTable<FoamStrainRate>& names_of(FoamStrainRate) {
  static const NameTable<FoamStrainRate> table = {{FoamStrainRate::mixture, "mixture"},
                                                  {FoamStrainRate::concrete, "concrete"}};
  return table;
}

const NameTable<FoamWetting>& names_of(FoamWetting) {
  static const NameTable<FoamWetting> table = {{FoamWetting::fraction, "fraction"},
                                               {FoamWetting::geometric, "geometric"}};
  return table;
}

const NameTable<FoamFaces>& names_of(FoamFaces) {
  static const NameTable<FoamFaces> table = {{FoamFaces::linear, "linear"},
                                             {FoamFaces::harmonic, "harmonic"}};
  return table;
}

namespace {

template <class Choice>
std::string name_of(Choice choice) {
  for (const auto& [known, name] : names_of(choice)) {
    if (known == choice) return name;
  }
  throw std::logic_error("a choice without a name");
}

}  // namespace

std::string to_string(Dimension choice) { return name_of(choice); }
std::string to_string(PrintDirection choice) { return name_of(choice); }
std::string to_string(Model choice) { return name_of(choice); }
std::string to_string(Scheme choice) { return name_of(choice); }
std::string to_string(Precision choice) { return name_of(choice); }
std::string to_string(Seeding choice) { return name_of(choice); }
std::string to_string(FluidUpdate choice) { return name_of(choice); }
std::string to_string(BBar choice) { return name_of(choice); }
std::string to_string(Wall choice) { return name_of(choice); }
std::string to_string(FoamLaws choice) { return name_of(choice); }
std::string to_string(FoamMixing choice) { return name_of(choice); }
std::string to_string(FoamStrainRate choice) { return name_of(choice); }
std::string to_string(FoamWetting choice) { return name_of(choice); }
std::string to_string(FoamFaces choice) { return name_of(choice); }

Model model_from_name(const std::string& name) {
  if (const auto model = choice_named<Model>(name)) return *model;
  const std::string near = nearest(name, all_names<Model>());
  throw SceneError("unknown model " + quoted(name) + (near.empty() ? "" : ", nearest is " + quoted(near)) +
                   "; allowed: " + joined(all_names<Model>()));
}

}  // namespace flowrest::scenes
