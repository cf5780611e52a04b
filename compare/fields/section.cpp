#include "compare/fields/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "compare/apparatus/apparatus.h"
#include "compare/fields/states.h"
#include "compare/run_view.h"
#include "runs/command.h"

namespace flowrest::compare::fields {

namespace {

constexpr std::pair<const char*, const char*> quantities[] = {
    {"shear rate", "1/s"}, {"pressure", "Pa"}, {"flocculation", ""}};
constexpr double cover_shown = 0.01;  ///< cells with less concrete at all times are left out

/// A run of the comparison and the states chosen of it.
struct Source {
  int entry = -1;
  std::unique_ptr<Recording> recording = {};
  std::vector<State> states = {};
  std::string missing = {};
};

/// How a run that left no states is made again.
std::string how_to_make(const RunView& view) {
  if (view.solver != "mpm" && view.solver != "foam") return "This run left no particles and no case to read.";
  const auto command = runs::command_to_make(view.run.info, view.solver, view.model);
  return fmt::format("This run's folder holds no {}. Make it anew{}",
                     view.solver == "mpm" ? "particles/particles.hdf.series" : "case/case.foam",
                     command ? ": " + *command : " from its scene.");
}

std::size_t nearest(const std::vector<double>& times, double time) {
  const auto closer = [time](double a, double b) { return std::abs(a - time) < std::abs(b - time); };
  return static_cast<std::size_t>(std::min_element(times.begin(), times.end(), closer) - times.begin());
}

/// At most `count` of the times that runs recorded: dense early, where most happens, and with the end.
std::vector<double> chosen_times(const std::vector<Source>& sources, double end, std::size_t count) {
  std::set<double> chosen;
  const Source* finest = nullptr;
  for (const Source& source : sources)
    if (source.recording && (!finest || source.recording->times().back() > finest->recording->times().back()))
      finest = &source;
  if (!finest) return {};
  const auto& times = finest->recording->times();
  for (std::size_t i = 0; i < count; ++i) {
    const double wish = end * std::pow(static_cast<double>(i) / static_cast<double>(count - 1), 2.2);
    chosen.insert(times[nearest(times, wish)]);
  }
  return {chosen.begin(), chosen.end()};
}

/// Of each run the state nearest to each time; none twice, and none that is further away than half a second
/// of the standard apparatus or a twentieth of the time.
void read_states(Source& source, const std::vector<double>& times, double time_unit) {
  std::set<std::size_t> wanted;
  const auto& recorded = source.recording->times();
  for (const double time : times) {
    const std::size_t index = nearest(recorded, time);
    const double away = std::abs(recorded[index] - time);
    if (away <= std::max(0.55 * time_unit, 0.05 * time) ||
        (time > recorded.back() && index + 1 == recorded.size()))
      wanted.insert(index);
  }
  for (const std::size_t index : wanted) source.states.push_back(source.recording->read(index));
}

std::uint16_t quantised(double value, double from, double to) {
  return static_cast<std::uint16_t>(
      std::lround(65535.0 * std::clamp((value - from) / (to - from), 0.0, 1.0)));
}

std::uint8_t coloured(double value, const report::Section::Quantity& quantity) {
  const double share = quantity.logarithmic ? std::log(std::max(value, quantity.from) / quantity.from) /
                                                  std::log(quantity.to / quantity.from)
                                            : (value - quantity.from) / (quantity.to - quantity.from);
  return static_cast<std::uint8_t>(
      std::lround(255.0 * std::clamp(std::isfinite(share) ? share : 0.0, 0.0, 1.0)));
}

/// Values of a quantity in concrete, of all states.
std::vector<double> gathered(const std::vector<Source>& sources, const std::string& name) {
  std::vector<double> values;
  for (const Source& source : sources)
    for (const State& state : source.states) {
      const auto found = state.values.find(name);
      if (found == state.values.end()) continue;
      for (std::size_t i = 0; i < found->second.size(); ++i)
        if (std::isfinite(found->second[i]) && (state.cover.empty() || state.cover[i] > 0.9))
          values.push_back(found->second[i]);
    }
  return values;
}

double quantile(std::vector<double>& values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<report::Section::Quantity> ranges(const std::vector<Source>& sources) {
  std::vector<report::Section::Quantity> found;
  for (const auto& [name, unit] : quantities) {
    auto values = gathered(sources, name);
    if (values.empty()) continue;
    const double high = quantile(values, 0.995);
    if (std::string(name) == "shear rate") {
      // Five decades below the fastest, so that creep and flow are both seen.
      const double top = std::pow(10.0, std::ceil(std::log10(std::max(high, 1e-3))));
      found.push_back({name, unit, 1e-5 * top, top, true});
    } else if (high > 0.0) {
      found.push_back({name, unit, 0.0, round_step(high), false});
    }
  }
  return found;
}

report::Section::Panel particles_panel(const Source& source, const report::Section& section,
                                       std::size_t most) {
  report::Section::Panel panel{.entry = source.entry};
  std::size_t step = 1;
  for (const State& state : source.states) step = std::max(step, (state.x.size() + most - 1) / most);
  panel.size = 1e3 * source.recording->spacing() * std::sqrt(static_cast<double>(step));
  for (const State& state : source.states) {
    report::Section::Frame frame{.time = state.time,
                                 .values = std::vector<std::vector<std::uint8_t>>(section.quantities.size())};
    for (std::size_t i = 0; i < state.x.size(); i += step) {
      frame.x.push_back(quantised(1e3 * state.x[i], *section.x.from, *section.x.to));
      frame.z.push_back(quantised(1e3 * state.z[i], *section.z.from, *section.z.to));
    }
    for (std::size_t q = 0; q < section.quantities.size(); ++q)
      if (const auto values = state.values.find(section.quantities[q].name); values != state.values.end())
        for (std::size_t i = 0; i < state.x.size(); i += step)
          frame.values[q].push_back(coloured(values->second[i], section.quantities[q]));
    panel.frames.push_back(std::move(frame));
  }
  return panel;
}

/// The cells that hold concrete in some state.
std::vector<std::size_t> covered(const Source& source) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < source.recording->cells().size(); ++i)
    if (std::any_of(source.states.begin(), source.states.end(),
                    [i](const State& s) { return s.cover[i] > cover_shown; }))
      kept.push_back(i);
  return kept;
}

report::Section::Panel cells_panel(const Source& source, const report::Section& section) {
  report::Section::Panel panel{.entry = source.entry};
  const Cells& cells = source.recording->cells();
  const auto kept = covered(source);
  for (const std::size_t i : kept) {
    panel.west.push_back(quantised(1e3 * cells.west[i], *section.x.from, *section.x.to));
    panel.east.push_back(quantised(1e3 * cells.east[i], *section.x.from, *section.x.to));
    panel.bottom.push_back(quantised(1e3 * cells.bottom[i], *section.z.from, *section.z.to));
    panel.top.push_back(quantised(1e3 * cells.top[i], *section.z.from, *section.z.to));
  }
  for (const State& state : source.states) {
    report::Section::Frame frame{.time = state.time,
                                 .values = std::vector<std::vector<std::uint8_t>>(section.quantities.size())};
    for (const std::size_t i : kept)
      frame.cover.push_back(
          static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(state.cover[i], 0.0, 1.0))));
    for (std::size_t q = 0; q < section.quantities.size(); ++q)
      if (const auto values = state.values.find(section.quantities[q].name); values != state.values.end())
        for (const std::size_t i : kept)
          frame.values[q].push_back(coloured(values->second[i], section.quantities[q]));
    panel.frames.push_back(std::move(frame));
  }
  return panel;
}

/// The smallest box around all that is concrete, m: west, east, bottom, top.
std::array<double, 4> extent_of(const std::vector<Source>& sources) {
  std::array<double, 4> box = {0.0, 0.0, 0.0, 0.0};
  const auto take = [&](double west, double east, double bottom, double top) {
    box = {std::min(box[0], west), std::max(box[1], east), std::min(box[2], bottom), std::max(box[3], top)};
  };
  for (const Source& source : sources) {
    if (!source.recording) continue;
    const Cells& cells = source.recording->cells();
    const double half = 0.5 * source.recording->spacing();
    if (cells.size() > 0)
      for (const std::size_t i : covered(source))
        take(cells.west[i], cells.east[i], cells.bottom[i], cells.top[i]);
    else
      for (const State& state : source.states)
        for (std::size_t i = 0; i < state.x.size(); ++i)
          take(state.x[i], state.x[i] + half, state.z[i], state.z[i] + half);
  }
  return box;
}

/// The height at which an L-box is cut level, m: 50 mm of one 600 mm high (Yu et al. 2026, Fig. 23).
double level_height(const Comparison& comparison) {
  return setting(comparison.runs.front(), "/geometry/reservoir_height").value_or(0.6) / 12.0;
}

std::optional<report::Section> section_of(const Comparison& comparison, const Cut& cut,
                                          std::size_t most_times, std::size_t budget) {
  std::vector<Source> sources;
  std::size_t recordings = 0;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const RunView& view = comparison.runs[i];
    if (view.exact || (cut.height && !is_solid(view))) continue;
    sources.push_back({static_cast<int>(i), recording_of(view, cut)});
    recordings += sources.back().recording != nullptr;
    if (!sources.back().recording) sources.back().missing = how_to_make(view);
  }
  if (recordings == 0) return std::nullopt;

  const auto times = chosen_times(sources, comparison.end, most_times);
  for (Source& source : sources)
    if (source.recording) read_states(source, times, comparison.thresholds.time_unit);

  report::Section section{.id = "sections", .title = "particles and volume fraction on the section"};
  section.caption =
      "Material point runs as particles, OpenFOAM as cells whose opacity is the fraction of concrete. Drag "
      "the slider, use the "
      "arrow keys, or press play; heights are stretched by the number under each panel.";
  section.times = times;
  section.quantities = ranges(sources);
  if (section.quantities.empty()) return std::nullopt;
  const auto [west, east, bottom, top] = extent_of(sources);
  section.x = {comparison.radial ? "radius" : "distance", "mm", false, false, 1e3 * west, 1020.0 * east};
  section.z = {"height", "mm", false, false, 1e3 * bottom, 1020.0 * top};
  if (cut.height) {
    section.id = "level-sections";
    section.title = fmt::format("seen from above, {:g} mm over the base", 1e3 * *cut.height);
    section.caption =
        "A level section, to scale: where bars have sheared the concrete, streaks of broken flocs (low λ) "
        "trail behind "
        "them. A half is shown from its plane of symmetry on.";
    section.z.name = "across";
    section.to_scale = true;
    // What the streaks are seen by comes first.
    std::stable_partition(section.quantities.begin(), section.quantities.end(),
                          [](const auto& quantity) { return quantity.name == "flocculation"; });
  }
  const std::size_t each = budget / (recordings * times.size() * (4 + section.quantities.size()));
  for (Source& source : sources) {
    if (!source.recording)
      section.panels.push_back({.entry = source.entry, .missing = source.missing});
    else if (source.recording->cells().size() > 0)
      section.panels.push_back(cells_panel(source, section));
    else
      section.panels.push_back(particles_panel(source, section, std::max<std::size_t>(each, 100)));
  }
  return section;
}

}  // namespace

std::vector<report::Section> sections_of(const Comparison& comparison, std::size_t most_times,
                                         std::size_t budget) {
  std::vector<report::Section> sections;
  if (!comparison.apparatus->has_depth()) return sections;
  const bool level = comparison.apparatus->seen_from_above() &&
                     std::any_of(comparison.runs.begin(), comparison.runs.end(),
                                 [](const RunView& view) { return !view.exact && is_solid(view); });
  const std::size_t each = level ? budget / 2 : budget;
  if (auto upright = section_of(comparison, {}, most_times, each)) sections.push_back(std::move(*upright));
  if (level)
    if (auto seen_from_above = section_of(comparison, {level_height(comparison)}, most_times, each))
      sections.push_back(std::move(*seen_from_above));
  return sections;
}

}  // namespace flowrest::compare::fields
