#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string>

#include "scenes/schema.h"
#include "scenes/value.h"

namespace flowrest::scenes {

/// Past this a mesh would fit no machine.
inline constexpr double most_cells = 2e9;

/// What a rule that refuses scenes needs at hand.
struct Case {
  const Given& given;
  const Draft& draft;
  Faults& faults;

  const Scene& scene() const { return draft.scene; }
  /// Whether anything may be concluded from these keys.
  bool usable(std::initializer_list<std::string> paths) const {
    return std::none_of(paths.begin(), paths.end(),
                        [&](const std::string& path) { return draft.unusable.contains(path); });
  }
  void fault(const std::string& path, const std::string& what) const {
    faults.add(given.place_of(path), what);
  }
  /// A cell that holds the whole body resolves nothing.
  void check_cell(const std::string& path, double cell, const std::string& body, double smallest) const {
    if (cell > smallest)
      fault(path, fmt::format("{} is {:g} m, larger than the {} ({:g} m); allowed: at most {:g}", path, cell,
                              body, smallest, smallest));
  }
  /// What is deeper or longer than the body is read nowhere. `key`: one of gauges; `sizes`: the keys that `most`
  /// follows from.
  void check_gauge(const std::string& key, double length, const std::string& what, double most,
                   std::initializer_list<std::string> sizes) const {
    if (!given.gives(key) || !usable({key}) || !usable(sizes) || length < most) return;
    fault(key,
          fmt::format("{} is {:g} m, and {} is {:g} m; allowed: less than that", key, length, what, most));
  }
};

}  // namespace flowrest::scenes
