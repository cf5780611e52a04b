#pragma once

#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "scenes/apparatus/dam_break.h"
#include "scenes/apparatus/duct.h"
#include "scenes/apparatus/l_box.h"
#include "scenes/apparatus/printing.h"
#include "scenes/apparatus/slump.h"
#include "scenes/apparatus/v_funnel.h"

/// The closed list of apparatus. A new one is a header and a source in this folder, a line above and one
/// below; whatever else it owes, the compiler names.
///
/// Every apparatus has: `name`, as scenes and run.json have it; `dimensions()`, `usual_dimension` and
/// `dimensions_meaning`; `under_gravity`; `rests`, whether a run ends at rest unless the scene says
/// otherwise; `keys()`; `body_height()` and `body_size()`, m, by which lengths are carried from one body to
/// another; `check` and `check_gauges`, which refuse sizes, and depths of gauges, that cannot be; `load`, what
/// a yield stress would have to hold; and `pieces`, what it is made of.
namespace flowrest::scenes {

using Apparatus = std::variant<Slump, Duct, LBox, VFunnel, DamBreak, Printing>;

/// The name of an apparatus, such as "slump".
std::string name_of(const Apparatus&);
/// Every name, in the order of the list.
std::vector<std::string> apparatus_names();
/// The apparatus of a name with its standard sizes; nothing where there is none of that name.
const Apparatus* apparatus_named(const std::string& name);

/// What runs of it are judged by.
MainGauge main_gauge_of(const Apparatus&);

/// Calls use(apparatus) with every apparatus in its standard sizes, in the order of the list.
template <class Use>
void for_each_apparatus(Use use) {
  [&]<std::size_t... I>(std::index_sequence<I...>) { (use(std::variant_alternative_t<I, Apparatus>{}), ...); }
  (std::make_index_sequence<std::variant_size_v<Apparatus>>{});
}

/// Place in the list of the apparatus A.
template <class A>
constexpr std::size_t index_of_apparatus() {
  std::size_t index = 0, found = 0;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((std::is_same_v<A, std::variant_alternative_t<I, Apparatus>> ? void(found = index) : void(), ++index),
     ...);
  }
  (std::make_index_sequence<std::variant_size_v<Apparatus>>{});
  return found;
}

}  // namespace flowrest::scenes
