#pragma once

#include <iterator>
#include <optional>
#include <string>

#include "laws/bi_viscous.h"
#include "laws/elasto_viscoplastic.h"
#include "laws/herschel_bulkley.h"
#include "laws/newtonian.h"
#include "laws/papanastasiou.h"
#include "laws/thixotropy.h"

/// The closed list of flow laws. What is asked of a law by its name or its value is asked here; who computes
/// with one takes it from `visit`.
namespace flowrest::laws {

/// In the order in which reports have them.
enum class Law { elasto_viscoplastic, papanastasiou, bi_viscous, herschel_bulkley, newtonian };
constexpr Law every_law[] = {Law::elasto_viscoplastic, Law::papanastasiou, Law::bi_viscous,
                             Law::herschel_bulkley, Law::newtonian};

/// Calls `use` with the law itself, an object without contents.
template <class Use>
constexpr auto visit(Law law, Use&& use) {
  switch (law) {
    case Law::elasto_viscoplastic:
      return use(ElastoViscoplastic{});
    case Law::papanastasiou:
      return use(Papanastasiou{});
    case Law::bi_viscous:
      return use(BiViscous{});
    case Law::herschel_bulkley:
      return use(HerschelBulkley{});
    case Law::newtonian:
      break;
  }
  return use(Newtonian{});
}

/// As in scenes, on the command line and in run.json.
constexpr const char* name_of(Law law) {
  return visit(law, [](auto own) { return decltype(own)::name; });
}
/// All of them in words: "a, b or c".
inline std::string all_names() {
  std::string names;
  for (const Law law : every_law)
    names += (law == every_law[0]              ? ""
              : law == std::end(every_law)[-1] ? " or "
                                               : ", ") +
             std::string(name_of(law));
  return names;
}
/// The law of a name, if it is one's.
inline std::optional<Law> law_named(const std::string& name) {
  for (const Law law : every_law)
    if (name == name_of(law)) return law;
  return std::nullopt;
}
/// A law's place in reports; behind all others where the name is no law's.
inline int order_of(const std::string& name) {
  int order = 0;
  for (const Law law : every_law) {
    if (name == name_of(law)) break;
    ++order;
  }
  return order;
}

/// Whether it has a state at rest. What has none is a fluid.
constexpr bool can_rest(Law law) {
  return visit(law, [](auto own) { return decltype(own)::can_rest; });
}
/// Whether it imitates a yield stress by a large viscosity, and so goes on flowing below it.
constexpr bool creeps(Law law) {
  return visit(law, [](auto own) { return decltype(own)::creeps; });
}
constexpr bool needs(Law law, Parameter parameter) {
  return visit(law, [parameter](auto own) {
    for (const Parameter needed : decltype(own)::needs)
      if (needed == parameter) return true;
    return false;
  });
}
/// Whether it has a yield stress, which structure can raise.
constexpr bool has_yield_stress(Law law) { return needs(law, Parameter::yield_stress); }

/// A law with its parameters: steady shear, for those who ask now and then.
struct FlowCurve {
  Law law = Law::elasto_viscoplastic;
  Parameters<double> parameters;

  /// Pa at a shear rate in 1/s.
  double stress(double rate) const {
    return visit(law, [&](auto own) { return own.stress(parameters, rate); });
  }
  /// The inverse of stress().
  double rate(double stress) const {
    return visit(law, [&](auto own) { return own.rate(parameters, stress); });
  }
  /// d stress / d rate, Pa s
  double tangent(double rate) const {
    return visit(law, [&](auto own) { return own.tangent(parameters, rate); });
  }
  /// Pa s
  double largest_viscosity() const {
    return visit(law, [&](auto own) { return own.largest_viscosity(parameters); });
  }
  /// About where it bends, 1/s.
  double yielding_rate() const {
    return visit(law, [&](auto own) { return own.yielding_rate(parameters); });
  }
};

}  // namespace flowrest::laws
